// Right-hand sides that act during short intervals of time only, far shorter than the step, in several
// spellings: y' = h within [a, b] and 0 elsewhere has y = h (b - a) at the end, whatever the method.
#include <algorithm>
#include <cstdio>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

struct Pulse {
  double from, to, height;
};

std::string written(const char* form, auto... values) {
  char text[200];
  std::snprintf(text, sizeof text, form, values...);
  return text;
}

/// `parameter`: named so, with the value of `from`.
std::string expression(Dice& d, const Pulse& p, const std::string& parameter) {
  switch (d.whole(0, 3)) {
    case 0:
      return written("(t > %.17g && t < %.17g ? %.17g : 0)", p.from, p.to, p.height);
    case 1:
      return written("%.17g*(t >= %.17g)*(t <= %.17g)", p.height, p.from, p.to);
    case 2:
      return written("(t - %s > 0 && t - %s < %.17g ? %.17g : 0)", parameter.c_str(), parameter.c_str(),
                     p.to - p.from, p.height);
    default:
      return written("%.17g*(sign(t-%.17g)-sign(t-%.17g))", 0.5 * p.height, p.from, p.to);
  }
}

}  // namespace

void pulses(Dice& d, Trial& t) {
  const double duration = d.of({50.0, 100.0, 200.0});
  const int n = d.whole(1, 4), steps = d.of({5, 7, 10, 20});
  std::string sum;
  json::object parameters;
  double area = 0, time = d.between(1, 10);
  for (int i = 0; i < n; ++i) {
    const double from = time + d.between(0, duration / n / 3);
    const Pulse p{from, from + d.spread(0.01, 3), d.between(-3, 3)};
    if (p.to >= duration) break;
    const std::string parameter{'s', static_cast<char>('0' + i)};
    parameters[parameter] = p.from;
    if (i > 0) sum += " + ";
    sum += expression(d, p, parameter);
    area += p.height * (p.to - p.from);
    time = p.to + d.between(0.1, duration / n / 2);
  }
  json::object system{{"type", "ode"},
                      {"integrator", d.of({"tsit5", "dopri5", "dop853", "radau5", "bs32", "cvode_bdf",
                                           "cvode_adams", "rk4", "rodas5p"})},
                      {"states", {{"y", 0}, {"x", 1}}},
                      {"parameters", parameters},
                      {"equations", {{"y", sum}, {"x", d.of({"0", "-0.3*x"})}}}};
  set_scene(t, duration / steps, duration, {}, {std::move(system)});
  expect_near(t, "a.y", area, 1e-7 * std::max(1.0, std::abs(area)), "area of the pulses");
}

}  // namespace truestep::campaign
