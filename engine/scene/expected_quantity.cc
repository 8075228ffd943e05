#include "engine/scene/expected_quantity.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <utility>

#include "engine/math/expression/names.h"

namespace truestep {

namespace {

constexpr std::pair<std::string_view, Reduction> kReductions[] = {
    {"start", Reduction::start}, {"min", Reduction::min},         {"max", Reduction::max},
    {"mean", Reduction::mean},   {"largest", Reduction::largest}, {"change", Reduction::change},
    {"drift", Reduction::drift},
};

bool letter(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) || c == '_';
}
/// Of names such as "s.q'.1", the rate of an element of a state.
bool in_name(char c) {
  return letter(c) || std::isdigit(static_cast<unsigned char>(c)) || c == '.' || c == '\'';
}

bool is_name(const std::string& text) {
  return !text.empty() && letter(text[0]) &&
         std::all_of(text.begin(), text.end(), [](char c) { return in_name(c) || c == '-'; });
}

std::string trimmed(std::string_view text) {
  const size_t first = text.find_first_not_of(' ');
  return first == text.npos ? "" : std::string(text.substr(first, text.find_last_not_of(' ') - first + 1));
}

/// Where the number that starts at `at` ends.
size_t number_end(const std::string& text, size_t at) {
  while (at < text.size() && (std::isdigit(static_cast<unsigned char>(text[at])) || text[at] == '.')) ++at;
  if (at + 1 >= text.size() || (text[at] != 'e' && text[at] != 'E')) return at;
  size_t digits = at + 1 + (text[at + 1] == '-' || text[at + 1] == '+');
  if (digits >= text.size() || !std::isdigit(static_cast<unsigned char>(text[digits]))) return at;
  while (digits < text.size() && std::isdigit(static_cast<unsigned char>(text[digits]))) ++digits;
  return digits;
}

/// What stands in the bracket of a call: its arguments, and where it is closed.
struct Call {
  std::vector<std::string> arguments;
  size_t end = 0;
};
Call call_at(const std::string& text, size_t open) {
  Call c;
  int depth = 0;
  size_t begin = open + 1;
  for (c.end = open; c.end < text.size(); ++c.end) {
    if (text[c.end] == '(') ++depth;
    const bool closed = text[c.end] == ')' && --depth == 0;
    if (closed || (text[c.end] == ',' && depth == 1)) {
      c.arguments.push_back(trimmed(std::string_view(text).substr(begin, c.end - begin)));
      begin = c.end + 1;
    }
    if (closed) return c;
  }
  throw ExpressionFault{open, "this bracket is never closed", ""};
}

/// Copies a text with its observables, and calls that `call` accepts, replaced by q0, q1 ...
template <class Value, class OfCall>
std::string replaced(const std::string& text, Value value, OfCall call) {
  std::string out;
  for (size_t at = 0; at < text.size();) {
    size_t end = at + 1;
    if (std::isdigit(static_cast<unsigned char>(text[at])) || text[at] == '.') {
      out.append(text, at, (end = number_end(text, at)) - at);
    } else if (letter(text[at])) {
      while (end < text.size() && in_name(text[end])) ++end;
      const std::string name = text.substr(at, end - at);
      const size_t open = text.find_first_not_of(' ', end);
      if (open != text.npos && text[open] == '(') {
        const Call c = call_at(text, open);
        if (const auto number = call(name, c.arguments, at)) {
          out += 'q' + std::to_string(*number);
          end = c.end + 1;
        } else {
          out += name;
        }
      } else {
        out += name == "t" || name == "pi" ? name : 'q' + std::to_string(value(name));
      }
    } else {
      out += text[at];
    }
    at = end;
  }
  return out;
}

/// A number that is written as one; empty otherwise.
std::optional<double> as_number(const std::string& text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [last, fault] = std::from_chars(text.data(), end, value);
  return fault == std::errc() && last == end ? std::optional(value) : std::nullopt;
}

/// A text over q0 ... q(count - 1) and t.
ExpressionProgram compiled(const std::string& text, size_t count) {
  ExpressionGraph graph;
  ExpressionNames names;
  for (size_t i = 0; i < count; ++i)
    names.add_value('q' + std::to_string(i), graph.variable(static_cast<int32_t>(i)));
  names.add_value("t", graph.variable(static_cast<int32_t>(count)));
  const ExpressionGraph::Node root[] = {names.require(graph, text)};
  return {graph, root, count + 1};
}

double evaluated(const ExpressionProgram& program, const std::vector<double>& values, double t) {
  std::vector<double> registers(program.registers());
  program.start(registers.data());
  std::copy(values.begin(), values.end(), registers.begin());
  registers[values.size()] = t;
  double out = 0;
  program.run(registers.data(), &out);
  return out;
}

}  // namespace

QuantityTerm::QuantityTerm(const std::string& text) {
  if (is_name(text) && text != "t" && text != "pi") {
    names_ = {text};
    return;
  }
  const auto number_of = [this](const std::string& name) {
    const auto at = std::find(names_.begin(), names_.end(), name);
    if (at != names_.end()) return static_cast<size_t>(at - names_.begin());
    names_.push_back(name);
    return names_.size() - 1;
  };
  const auto no_reduction = [](auto&&...) { return std::optional<size_t>(); };
  const std::string plain = replaced(text, number_of, no_reduction);
  program_ = compiled(plain, names_.size());
}

std::optional<double> QuantityTerm::value(const Observables& values, double t) const {
  if (plain()) return values.find(names_[0]);
  std::vector<double> found;
  for (const std::string& name : names_) {
    const auto v = values.find(name);
    if (!v) return std::nullopt;
    found.push_back(*v);
  }
  return evaluated(*program_, found, t);
}

ExpectedQuantity::ExpectedQuantity(const std::string& text) {
  try {
    read(text == "energy.drift" ? "drift(energy.total)" : trimmed(text));
  } catch (ExpressionFault& fault) {
    // Its place is in what was left after names had been replaced.
    fault.position = std::min(fault.position, text.size());
    throw;
  }
}

void ExpectedQuantity::read(const std::string& text) {
  const auto track = [this](Reduction reduction, const std::string& of) {
    tracks_.push_back({reduction, QuantityTerm(of), std::nullopt, std::nullopt});
    return tracks_.size() - 1;
  };
  const auto value = [&](const std::string& name) {
    if (name == "energy.gain") return track(Reduction::gain, "energy.total");
    if (name == "energy.loss") return track(Reduction::loss, "energy.total");
    return track(Reduction::last, name);
  };
  if (is_name(text) && text != "t" && text != "pi") {
    value(text);
    return;
  }
  const auto reduced = [&](const std::string& name, const std::vector<std::string>& arguments, size_t at) {
    const auto row = std::find_if(std::begin(kReductions), std::end(kReductions),
                                  [&](const auto& r) { return r.first == name; });
    // Of two arguments, min and max are the usual functions.
    if (row == std::end(kReductions) || (arguments.size() != 1 && arguments.size() != 3))
      return std::optional<size_t>();
    const size_t number = track(row->second, arguments[0]);
    QuantityTrack& t = tracks_[number];
    if (row->second == Reduction::drift && !t.term.plain())
      throw ExpressionFault{at, "drift takes one observable; change(...) takes an expression", "change"};
    if (arguments.size() == 3) {
      t.from = as_number(arguments[1]), t.until = as_number(arguments[2]);
      if (!t.from || !t.until)
        throw ExpressionFault{at, "expected " + name + "(x, from, until) with two times in s", ""};
    }
    return std::optional<size_t>(number);
  };
  const std::string outer = replaced(text, value, reduced);
  if (outer != "q0") program_ = compiled(outer, tracks_.size());
}

std::optional<Reduction> ExpectedQuantity::only() const {
  return program_ ? std::nullopt : std::optional(tracks_[0].reduction);
}

double ExpectedQuantity::combine(const std::vector<double>& tracks, double t) const {
  return program_ ? evaluated(*program_, tracks, t) : tracks[0];
}

}  // namespace truestep
