// Units of a scene's numbers.
#include "engine/scene/units.h"

#include <gtest/gtest.h>

namespace truestep {
namespace {

TEST(Units, NumbersBecomeSi) {
  struct Case {
    const char *text, *si;
    double value;
  };
  for (const Case& c : {Case{"5 cm", "m", 0.05},
                        {"2 kN/m", "N/m", 2000},
                        {"30 deg", "rad", 0.5235987755982988},
                        {"90 rpm", "rad/s", 9.42477796076938},
                        {"1 g/cm^3", "kg/m^3", 1000},
                        {"2 t", "kg", 2000},
                        {"3 L/min", "m^3/s", 5e-5},
                        {"40 kPa s", "N s/m^2", 40000},
                        {"12 ft/s^2", "m/s^2", 3.6576},
                        {"5 %", "", 0.05},
                        {"1 m/s^2 s", "m/s", 1},
                        {"6 J/kg K", "m^2 K/s^2", 6},
                        {"6 J/kg/K", "m^2/s^2/K", 6},
                        {"2 N m^-1", "kg/s^2", 2},
                        {"7 uC*V", "J", 7e-6}}) {
    const Quantity q = parse_quantity(c.text, c.si);
    ASSERT_TRUE(q.value) << c.text << ": " << q.error;
    EXPECT_NEAR(*q.value / c.value, 1, 1e-14) << c.text;
  }
}

TEST(Units, AnotherDimensionIsRefused) {
  for (const auto& [text, si] : {std::pair("5 cm", "s"),
                                 {"5", "m"},
                                 {"1 m/s^2 s", "m/s^3"},
                                 {"6 J/kg K", "m^2/s^2/K"},
                                 {"2 lightyears", "m"},
                                 {"2 N/", "N"},
                                 {"m", "m"},
                                 {"1e999 m", "m"}}) {
    EXPECT_FALSE(parse_quantity(text, si).value) << text;
    EXPECT_FALSE(parse_quantity(text, si).error.empty()) << text;
  }
}

}  // namespace
}  // namespace truestep
