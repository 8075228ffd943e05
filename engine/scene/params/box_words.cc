#include "engine/scene/params/box_words.h"

#include <algorithm>
#include <array>

#include "engine/scene/units.h"

namespace truestep {

namespace json = boost::json;

namespace {

constexpr std::array<std::string_view, 3> kNotHalf{"size", "low", "high"},
    kNotSize{"half_extents", "low", "high"}, kNotCorners{"half_extents", "size", "center"};
constexpr std::array<std::string_view, 2> kNotEdges{"half_extents", "size"};

/// A list of lengths (m); one number stands for three.
using Lengths = std::vector<double>;

std::optional<Lengths> lengths(const json::object& o, std::string_view word) {
  const json::value* v = o.if_contains(word);
  if (!v) return std::nullopt;
  const auto one = [](const json::value& e) -> std::optional<double> {
    if (e.is_number()) return e.to_number<double>();
    if (!e.is_string()) return std::nullopt;
    return parse_quantity(std::string_view(e.as_string()), "m").value;
  };
  Lengths out;
  if (const json::array* list = v->if_array()) {
    for (const json::value& e : *list) {
      const auto x = one(e);
      if (!x) return std::nullopt;
      out.push_back(*x);
    }
  } else if (const auto x = one(*v)) {
    out.assign(3, *x);
  }
  return out.empty() || out.size() > 3 ? std::nullopt : std::optional(out);
}

Lengths sum(const Lengths& a, double factor, const Lengths& b) {
  Lengths out = a;
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) out[i] += factor * b[i];
  return out;
}
Lengths times(double factor, const Lengths& a) {
  return sum(Lengths(a.size(), 0.0), factor, a);
}
json::array written(const Lengths& a) {
  return json::array(a.begin(), a.end());
}

enum class Own : uint8_t { none, half, size, corners, edges };

bool is_lengths(const DefTable& table, std::string_view name) {
  const ParamRow* row = table.find(name);
  return row && row->unit == "m" && (row->kind == ParamKind::vector || row->kind == ParamKind::numbers);
}
Own own_words(const DefTable& table) {
  if (is_lengths(table, "half_extents")) return Own::half;
  if (is_lengths(table, "size")) return Own::size;
  if (is_lengths(table, "low") && is_lengths(table, "high")) return Own::corners;
  return is_lengths(table, "box") ? Own::edges : Own::none;
}

/// What an object says of a box in words that are not the table's own.
struct Box {
  std::optional<Lengths> edges, low, middle;
};
Box box_of(const json::object& o) {
  Box b;
  const auto half = lengths(o, "half_extents"), low = lengths(o, "low"), high = lengths(o, "high");
  b.edges = half ? times(2, *half) : lengths(o, "size");
  if (low && high && low->size() == high->size()) b.edges = sum(*high, -1, *low);
  b.low = low ? low : lengths(o, "origin");
  b.middle = lengths(o, "center");
  if (b.edges && b.low && !b.middle) b.middle = sum(*b.low, 0.5, *b.edges);
  if (b.edges && b.middle && !b.low) b.low = sum(*b.middle, -0.5, *b.edges);
  return b;
}

}  // namespace

std::span<const std::string_view> other_box_words(const DefTable& table) {
  switch (own_words(table)) {
    case Own::half:
      return kNotHalf;
    case Own::size:
      return kNotSize;
    case Own::corners:
      return kNotCorners;
    case Own::edges:
      return kNotEdges;
    case Own::none:
      break;
  }
  return {};
}

std::optional<json::object> box_in_own_words(const DefTable& table, const json::object& o) {
  const auto others = other_box_words(table);
  const auto foreign = [&](std::string_view word) { return !table.find(word) && o.contains(word); };
  if (std::ranges::none_of(others, foreign)) return std::nullopt;
  const Own own = own_words(table);
  const Box box = box_of(o);
  if (!box.edges) return std::nullopt;
  json::object out;
  const auto give = [&](std::string_view word, const std::optional<Lengths>& value) {
    if (!value || !is_lengths(table, word)) return true;
    const bool twice = o.contains(word);
    // A box of the plane in a table of space.
    Lengths whole = *value;
    if (table.find(word)->kind == ParamKind::vector) whole.resize(3, 0.0);
    out[word] = written(whole);
    return !twice;
  };
  // A place that is the table's own word stays as it is written.
  const auto place = [&](std::string_view word, const std::optional<Lengths>& value) {
    if (!o.contains(word)) give(word, value);
  };
  bool once = true;
  switch (own) {
    case Own::half:
      once = give("half_extents", times(0.5, *box.edges));
      if (foreign("low") || foreign("origin"))
        place(is_lengths(table, "center") ? "center" : "position", box.middle);
      break;
    case Own::size:
      once = give("size", box.edges);
      if (foreign("low") || foreign("center")) place("origin", box.low);
      break;
    case Own::corners: {
      // About the origin where nothing says where.
      const Lengths low = box.low.value_or(times(-0.5, *box.edges));
      place("low", low), place("high", sum(low, 1, *box.edges));
      once = !(o.contains("low") && o.contains("high"));
      break;
    }
    case Own::edges:
      once = give("box", box.edges);
      break;
    case Own::none:
      break;
  }
  if (!once) return std::nullopt;
  const auto is_box_word = [&](std::string_view key) {
    constexpr std::string_view kPlaces[] = {"origin", "center"};
    return std::ranges::find(others, key) != others.end() ||
           std::ranges::find(kPlaces, key) != std::end(kPlaces);
  };
  for (const auto& [key, value] : o) {
    if (!out.contains(key) && (table.find(key) || !is_box_word(key))) out[key] = value;
  }
  return out;
}

}  // namespace truestep
