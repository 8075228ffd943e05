// Units in scene strings: "5 cm", "30 deg", "1.2 MPa", "9.81 m/s^2". A unit is a product of powers of SI base
// units with a factor; it fits a parameter when the powers agree.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace truestep {

/// value_in_SI = value * factor; powers of kg, m, s, A, K (angles are pure numbers).
struct Unit {
  double factor = 1;
  std::array<int, 5> powers{};
};

/// Parses "N/m", "kg m/s^2", "mm", "deg", "1" ...; empty when a name is unknown.
std::optional<Unit> parse_unit(std::string_view text);

/// A number followed by a unit, in SI. `error` says what is wrong when there is no value.
struct Quantity {
  std::optional<double> value;
  std::string error;
};
/// `si_unit` is the parameter's unit, e.g. "N/m"; a string without a unit is refused unless it is "1".
Quantity parse_quantity(std::string_view text, std::string_view si_unit);

}  // namespace truestep
