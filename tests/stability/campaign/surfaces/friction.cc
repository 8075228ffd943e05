// Oscillators with dry friction: m x'' = -k x - F sign(x'). Every half swing is a sine about +-F / k, so that
// the place where it sticks is known: the first turn within F / k of the middle.
#include <cmath>
#include <numbers>
#include <string>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {

void friction(Dice& d, Trial& t) {
  const double m = d.spread(0.1, 10), k = d.spread(0.1, 100), reach = d.spread(0.01, 1);
  // Far enough from a turn that just sticks, or just does not.
  const int swings = d.whole(0, 12);
  const double last = d.between(-0.95, 0.95) * reach, sign = d.sign();
  const double x0 = sign * (2 * reach * swings + last), sticks = sign * (swings % 2 ? -1 : 1) * last;
  const double half = std::numbers::pi * std::sqrt(m / k);
  json::object a{{"type", "ode"}, {"parameters", json::object{{"m", m}, {"k", k}, {"F", reach * k}}}};
  if (d.chance(0.5)) {
    a["states"] = json::object{{"x", x0}, {"v", 0}};
    a["equations"] = json::object{{"x", "v"}, {"v", "(-k*x - F*sign(v))/m"}};
  } else {
    a["states"] = json::object{{"x", x0}};
    a["second"] = json::object{{"x", "(-k*x - F*sign(x'))/m"}};
  }
  const std::string method = d.of({"", "", "rk4", "dopri5", "dop853", "radau5"});
  if (!method.empty()) a["integrator"] = method;
  const double dt = half / d.whole(5, 60);
  set_scene(t, method == "rk4" ? half / 60 : dt, half * (swings + 2), {}, json::array{a});
  expect_near(t, "a.x", sticks, 1e-4 * reach, "it sticks at the first turn within friction's reach");
  t.rules.gain.reset();
}

}  // namespace truestep::campaign
