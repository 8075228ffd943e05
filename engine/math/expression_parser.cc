// Recursive descent, one function per level of precedence:
//   choice  := either ("?" choice ":" choice)?      either := both ("||" both)*      both := compare ("&&"
//   compare)* compare := sum (op sum)?   sum := product (("+"|"-") product)*   product := sign (("*"|"/")
//   sign)* sign    := "-" sign | "+" sign | power          power  := atom ("^" sign)? atom    := number |
//   name | name "(" choice ("," choice)? ")" | "(" choice ")"
#include <charconv>
#include <cmath>

#include "engine/math/expression.h"

namespace truestep {

class ExpressionParser {
 public:
  using Op = Expression::Op;

  ExpressionParser(std::string_view text, std::span<const std::string> variables,
                   std::span<const std::pair<std::string, double>> constants)
      : text_(text), variables_(variables), constants_(constants) {}

  Expression parse() {
    if (text_.size() > Expression::kMaxLength) fail(Expression::kMaxLength, "longer than 1000 characters");
    choice();
    skip_spaces();
    if (at_ < text_.size()) {
      fail(at_, text_[at_] == '=' ? "assignment is not possible; compare with =="
                                  : "unexpected \"" + std::string(1, text_[at_]) + '"');
    }
    return std::move(out_);
  }

 private:
  struct Function {
    std::string_view name;
    Op op;
    int arguments;
  };
  static constexpr Function kFunctions[] = {
      {"sqrt", Op::sqrt, 1}, {"abs", Op::abs, 1},   {"sign", Op::sign, 1},   {"floor", Op::floor, 1},
      {"exp", Op::exp, 1},   {"log", Op::log, 1},   {"sin", Op::sin, 1},     {"cos", Op::cos, 1},
      {"tan", Op::tan, 1},   {"asin", Op::asin, 1}, {"acos", Op::acos, 1},   {"atan", Op::atan, 1},
      {"pow", Op::power, 2}, {"min", Op::min, 2},   {"atan2", Op::atan2, 2}, {"max", Op::max, 2},
  };

  [[noreturn]] static void fail(size_t position, std::string message) {
    throw ExpressionFault{position, std::move(message)};
  }
  void skip_spaces() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  }
  /// Takes the token when it comes next.
  bool take(std::string_view token) {
    skip_spaces();
    if (text_.substr(at_, token.size()) != token) return false;
    at_ += token.size();
    return true;
  }
  void expect(std::string_view token) {
    if (!take(token)) fail(at_, "expected \"" + std::string(token) + '"');
  }

  /// Appends an instruction; `effect` is what it does to the number of values on the stack.
  void emit(Expression::Instruction in, int effect) {
    if (out_.code_.size() == Expression::kMaxInstructions) fail(at_, "too many operations");
    height_ += effect;
    if (height_ > static_cast<int>(Expression::kMaxStack)) fail(at_, "nested too deeply");
    out_.code_.push_back(in);
  }

  void choice() {
    if (++depth_ > 64) fail(at_, "nested too deeply");
    either();
    if (take("?")) {
      choice();
      expect(":");
      choice();
      emit({Op::choose}, -2);
    }
    --depth_;
  }
  void either() {
    both();
    while (take("||")) both(), emit({Op::either}, -1);
  }
  void both() {
    compare();
    while (take("&&")) compare(), emit({Op::both}, -1);
  }
  void compare() {
    sum();
    static constexpr std::pair<std::string_view, Op> kOps[] = {
        {"<=", Op::less_equal}, {">=", Op::greater_equal}, {"==", Op::equal},
        {"!=", Op::not_equal},  {"<", Op::less},           {">", Op::greater}};
    for (const auto& [token, op] : kOps) {
      if (!take(token)) continue;
      sum();
      emit({op}, -1);
      return;
    }
  }
  void sum() {
    product();
    while (true) {
      if (take("+")) {
        product(), emit({Op::add}, -1);
      } else if (take("-")) {
        product(), emit({Op::subtract}, -1);
      } else {
        return;
      }
    }
  }
  void product() {
    sign();
    while (true) {
      if (take("*")) {
        sign(), emit({Op::multiply}, -1);
      } else if (take("/")) {
        sign(), emit({Op::divide}, -1);
      } else {
        return;
      }
    }
  }
  void sign() {
    if (++depth_ > 64) fail(at_, "nested too deeply");
    if (take("-")) {
      sign(), emit({Op::negate}, 0);
    } else if (take("+")) {
      sign();
    } else {
      power();
    }
    --depth_;
  }
  void power() {
    atom();
    if (!take("^")) return;
    const size_t first = out_.code_.size();
    sign();
    raise(first);
  }
  /// Turns the exponent that begins at instruction `first` into a power of what lies below it.
  void raise(size_t first) {
    auto& code = out_.code_;
    const bool negative = code.size() == first + 2 && code.back().op == Op::negate;
    if ((code.size() == first + 1 || negative) && code[first].op == Op::constant) {
      const double n = negative ? -code[first].value : code[first].value;
      if (n == std::floor(n) && std::fabs(n) <= 64) {
        code.resize(first);
        --height_;
        return emit({Op::integer_power, static_cast<int32_t>(n)}, 0);
      }
    }
    emit({Op::power}, -1);
  }
  void atom() {
    skip_spaces();
    if (at_ == text_.size()) fail(at_, "ends where a value is expected");
    const char c = text_[at_];
    if (take("(")) {
      choice();
      expect(")");
    } else if ((c >= '0' && c <= '9') || c == '.') {
      number();
    } else if (letter(c)) {
      name();
    } else {
      fail(at_, "expected a value, not \"" + std::string(1, c) + '"');
    }
  }
  static bool letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
  void number() {
    double value = 0;
    const char* end = text_.data() + text_.size();
    const auto [rest, error] = std::from_chars(text_.data() + at_, end, value);
    if (error != std::errc{} || !std::isfinite(value)) fail(at_, "this is no finite number");
    at_ = static_cast<size_t>(rest - text_.data());
    emit({Op::constant, 0, value}, 1);
  }
  void name() {
    const size_t start = at_;
    while (at_ < text_.size() && (letter(text_[at_]) || (text_[at_] >= '0' && text_[at_] <= '9'))) ++at_;
    const std::string_view id = text_.substr(start, at_ - start);
    for (const Function& f : kFunctions) {
      if (f.name == id) return call(f);
    }
    for (size_t k = 0; k < variables_.size(); ++k) {
      if (variables_[k] == id) return emit({Op::variable, static_cast<int32_t>(k)}, 1);
    }
    for (const auto& [constant, value] : constants_) {
      if (constant == id) return emit({Op::constant, 0, value}, 1);
    }
    if (id == "pi") return emit({Op::constant, 0, 3.141592653589793}, 1);
    std::string known;
    for (const std::string& v : variables_) known += v + ' ';
    fail(start, "unknown name \"" + std::string(id) + "\"; variables: " + known);
  }
  void call(const Function& f) {
    expect("(");
    choice();
    const size_t second = out_.code_.size();
    if (f.arguments == 2) {
      expect(",");
      choice();
    }
    expect(")");
    if (f.op == Op::power) return raise(second);
    emit({f.op}, 1 - f.arguments);
  }

  std::string_view text_;
  std::span<const std::string> variables_;
  std::span<const std::pair<std::string, double>> constants_;
  Expression out_;
  size_t at_ = 0;
  int height_ = 0, depth_ = 0;
};

Expression Expression::parse(std::string_view text, std::span<const std::string> variables,
                             std::span<const std::pair<std::string, double>> constants) {
  return ExpressionParser(text, variables, constants).parse();
}

}  // namespace truestep
