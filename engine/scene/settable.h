// What the command set_parameter takes of every type of system: the table that commands are checked against
// and that descriptions list. Names with an angle bracket stand for names of the scene.
#pragma once
#include <span>
#include <string_view>

namespace truestep {

struct SettableParameter {
  std::string_view name;
  enum class Form : uint8_t {
    number,  ///< in "value"
    vector,  ///< in "vector"
    either   ///< as in the scene
  } form = Form::number;
  enum class Of : uint8_t {
    system,  ///< no row
    body,    ///< "index" is a body
    joint    ///< "index" is a joint
  } of = Of::system;
  std::string_view unit = {};  ///< empty: that of the scene's parameter of this name
  std::string_view sentence = {};
};

/// Rows of that type of system; empty when nothing can be set.
std::span<const SettableParameter> settable_parameters(std::string_view system_type);

constexpr std::string_view name_of(SettableParameter::Of of) {
  constexpr std::string_view kNames[] = {"system", "body", "joint"};
  return kNames[static_cast<size_t>(of)];
}
constexpr std::string_view name_of(SettableParameter::Form form) {
  constexpr std::string_view kNames[] = {"number", "vector", "number or vector"};
  return kNames[static_cast<size_t>(form)];
}

}  // namespace truestep
