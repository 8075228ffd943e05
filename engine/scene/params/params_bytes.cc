#include "engine/scene/params/params_bytes.h"

#include <string>

namespace truestep {

namespace {

constexpr double kBlock = 16;  // the allocator's own bytes of a block, rounding included
constexpr double kSpare =
    1.3;  // lists grow by doubling, and are on average so much longer than their contents
constexpr size_t kInPlace = 15;  // letters of a text that take no block

double of_text(const std::string& s) {
  return s.size() > kInPlace ? static_cast<double>(s.size()) + kBlock : 0;
}

template <class T>
double of_elements(const std::vector<T>& list) {
  return list.empty() ? 0 : static_cast<double>(sizeof(T) * list.size()) + kBlock;
}

double of_value(const ParamValue& value) {
  return std::visit(
      [](const auto& v) -> double {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, std::string>) {
          return of_text(v);
        } else if constexpr (std::is_same_v<T, std::vector<std::string>>) {
          double sum = of_elements(v);
          for (const std::string& s : v) sum += of_text(s);
          return sum;
        } else if constexpr (std::is_same_v<T, std::vector<NamedNumbers>>) {
          double sum = of_elements(v);
          for (const NamedNumbers& n : v) sum += of_text(n.name) + of_elements(n.values);
          return sum;
        } else if constexpr (std::is_same_v<T, std::vector<NamedText>>) {
          double sum = of_elements(v);
          for (const NamedText& n : v) sum += of_text(n.name) + of_text(n.text);
          return sum;
        } else if constexpr (requires { v.size(); }) {
          return of_elements(v);
        } else {
          return 0;
        }
      },
      value);
}

// Whether a value of this kind can lie outside its struct.
bool lies_apart(ParamKind kind) {
  return kind != ParamKind::number && kind != ParamKind::integer && kind != ParamKind::boolean &&
         kind != ParamKind::choice && kind != ParamKind::vector;
}

// A struct's size: the distance of two in a list, or, of a single one, what members of its kinds take.
double size_of(const ParamRow& row, const void* first, const void* second, const DefTable& table) {
  if (first && second && row.kind != ParamKind::object) {
    return static_cast<double>(static_cast<const char*>(second) - static_cast<const char*>(first));
  }
  constexpr double kNumber = 8, kOther = 28;
  double sum = 0;
  for (const ParamRow& r : table.rows) sum += r.kind == ParamKind::number ? kNumber : kOther;
  return sum;
}

double of_variants(const ParamRow& row, const void* owner) {
  const size_t n = row.size(owner);
  double sum = 0;
  const void* places[2] = {nullptr, nullptr};
  const DefTable* last = nullptr;
  for (size_t i = 0; i < n; ++i) {
    for (const ParamVariant& v : row.variants) {
      const void* element = v.at(owner, i);
      if (!element) continue;
      if (i < 2) places[i] = element;
      last = v.table;
      sum += heap_bytes(*v.table, element);
    }
  }
  const double each = last ? size_of(row, places[0], places[1], *last) : 0;
  return n > 0 ? sum + kSpare * each * static_cast<double>(n) + kBlock : 0;
}

double of_objects(const ParamRow& row, const void* owner) {
  const size_t n = row.size(owner);
  double sum = 0;
  for (size_t i = 0; i < n; ++i) sum += heap_bytes(*row.nested, row.at(owner, i));
  if (n == 0 || row.kind == ParamKind::object) return sum;
  const double each = size_of(row, row.at(owner, 0), n > 1 ? row.at(owner, 1) : nullptr, *row.nested);
  return sum + kSpare * each * static_cast<double>(n) + kBlock;
}

}  // namespace

double heap_bytes(const DefTable& table, const void* owner) {
  double sum = 0;
  for (const ParamRow& r : table.rows) {
    if (r.kind == ParamKind::variants) {
      sum += of_variants(r, owner);
    } else if (r.kind == ParamKind::object || r.kind == ParamKind::objects) {
      sum += of_objects(r, owner);
    } else if (lies_apart(r.kind)) {
      sum += of_value(r.get(owner));
    }
  }
  return sum;
}

}  // namespace truestep
