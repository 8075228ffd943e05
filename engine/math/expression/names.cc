#include "engine/math/expression/names.h"

#include <algorithm>

#include "engine/math/expression/lexis.h"

namespace truestep {

using namespace lexis;
using Node = ExpressionGraph::Node;

bool good_expression_name(std::string_view name) {
  return name_length(name, 0) == name.size() && !name.empty() && name.size() <= 64 && !find_function(name) &&
         name != "pi" && name != "sum" && name != "len";
}

std::string describe(const ExpressionFault& fault, std::string_view text) {
  const size_t at = std::min(fault.position, text.size());
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  const size_t start = text.substr(0, at).rfind('\n') + 1;  // npos + 1 = 0
  constexpr size_t kAround = 24;
  const auto plain = [](std::string_view s) {
    std::string out(s);
    for (char& c : out) {
      if (c < ' ' || c > '~') c = c == '\n' ? ' ' : '?';
    }
    return out;
  };
  const size_t first = std::max(start, at > kAround ? at - kAround : 0);
  return fault.message + " (line " + std::to_string(line) + ", column " + std::to_string(at - start + 1) +
         ": " + (first > start ? "..." : "") + plain(text.substr(first, at - first)) + ">>>" +
         plain(text.substr(at, kAround)) + (at + kAround < text.size() ? "...)" : ")");
}

ExpressionTarget parse_expression_target(std::string_view text) {
  ExpressionTarget out;
  size_t at = 0;
  const auto skip = [&] {
    while (at < text.size() && blank(text[at])) ++at;
  };
  skip();
  const size_t length = name_length(text, at);
  if (length == 0) throw ExpressionFault{at, "expected a name, or a name with indices such as x[i]", ""};
  out.name = text.substr(at, length);
  at += length;
  skip();
  if (at < text.size() && text[at] == '[') {
    do {
      ++at;
      skip();
      size_t n = name_length(text, at);
      if (n == 0) {
        while (at + n < text.size() && digit(text[at + n]) && n < 7) ++n;
      }
      if (n == 0) throw ExpressionFault{at, "expected an index name or a number", ""};
      out.indices.emplace_back(text.substr(at, n));
      at += n;
      skip();
    } while (at < text.size() && text[at] == ',' && out.indices.size() < 4);
    if (at == text.size() || text[at] != ']') throw ExpressionFault{at, "expected \"]\"", ""};
    ++at;
    skip();
  }
  if (at != text.size()) throw ExpressionFault{at, "expected the end of the name", ""};
  return out;
}

bool ExpressionNames::add(Symbol symbol) {
  if (!good_expression_name(symbol.name) || by_name_.contains(symbol.name)) return false;
  by_name_.emplace(symbol.name, symbols_.size());
  symbols_.push_back(std::move(symbol));
  return true;
}
bool ExpressionNames::add_value(std::string name, Node value) {
  return add({Symbol::Kind::value, std::move(name), {value}, {}, {}, {}});
}
bool ExpressionNames::add_array(std::string name, std::vector<Node> elements) {
  return add({Symbol::Kind::array, std::move(name), std::move(elements), {}, {}, {}});
}
bool ExpressionNames::add_definition(std::string name, std::vector<std::string> indices, std::string text) {
  return add({Symbol::Kind::definition, std::move(name), {}, std::move(indices), std::move(text), {}});
}

}  // namespace truestep
