// Processor time against error of the explicit methods, beside Boost.odeint (dopri5 and fehlberg78 on
// std::vector) and CVODE's Adams methods where they are built in: Kepler's orbit of eccentricity 0.6 over 100
// periods, the Pleiades problem, Arenstorf's orbit and a hanging chain of 1,000 masses that is mildly stiff.
// All evaluate the same right-hand sides, ours through the virtual interface that the product uses. Every
// method runs over a row of tolerances; times at equal error are interpolated between them on log-log axes,
// and the best method of each side counts. `--curves` prints every run to stderr; `--problem NAME` runs one
// problem only.
#include <algorithm>
#include <array>
#include <boost/numeric/odeint.hpp>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "engine/base/errors.h"
#include "engine/core/integrator.h"
#include "engine/integrators/advance.h"
#include "tests/bench/report.h"
#include "tests/support/ode_problems.h"

namespace truestep::bench {
namespace {

namespace odeint = boost::numeric::odeint;
using test::relative_error;
using Vector = std::vector<double>;

struct Method {
  std::string name;
  enum class Side : uint8_t { ours, odeint, cvode } side;
  std::function<Vector(double tolerance)> run;
  std::vector<double> tolerances;
};

struct Problem {
  std::string name;
  double t_end;
  Vector start, reference;
  double first_step;  // odeint wants one
  std::vector<std::string_view> ours;
  std::vector<double> tolerances;
};

struct Point {
  double tolerance, seconds, error;
};

std::vector<double> powers(int from, int to) {
  std::vector<double> all;
  for (int e = from; e <= to; ++e) all.push_back(std::pow(10.0, -e));
  return all;
}

Vector integrate(const Integrator& row, const RightHandSide& f, const Problem& p, double tolerance) {
  Vector y = p.start;
  static Workspace workspace;
  Carry carry;
  Advance advance{.f = f,
                  .t = 0,
                  .t_end = p.t_end,
                  .y = y.data(),
                  .workspace = workspace,
                  .carry = carry,
                  .tolerance = {.relative = tolerance, .absolute = tolerance}};
  try {
    row.advance(advance);
  } catch (const Instability&) {
    return {};  // so coarse that the bodies collide, or finer than double precision
  }
  return y;
}

template <class Stepper, class F>
Vector integrate_odeint(const F& f, const Problem& p, double tolerance) {
  Vector y = p.start;
  const auto rate = [&f](const Vector& at, Vector& d, double t) { f.rate(t, at.data(), d.data()); };
  odeint::integrate_adaptive(odeint::make_controlled(tolerance, tolerance, Stepper()), rate, y, 0.0, p.t_end,
                             p.first_step);
  return y;
}

template <class F>
std::vector<Method> methods(const F& f, const Problem& p) {
  std::vector<Method> all;
  const auto add_row = [&](std::string_view name, Method::Side side) {
    const Integrator* row = find_integrator(name);
    if (!row || !row->advance) return;
    all.push_back({std::string(name), side,
                   [&f, &p, row](double tolerance) { return integrate(*row, f, p, tolerance); },
                   p.tolerances});
  };
  for (const std::string_view name : p.ours) add_row(name, Method::Side::ours);
  // Not on the chain: functional iteration makes it 40 times slower than odeint there, and minutes long.
  if (p.start.size() < 100) add_row("cvode_adams", Method::Side::cvode);
  all.push_back({"odeint dopri5", Method::Side::odeint,
                 [&](double tol) { return integrate_odeint<odeint::runge_kutta_dopri5<Vector>>(f, p, tol); },
                 p.tolerances});
  all.push_back(
      {"odeint fehlberg78", Method::Side::odeint,
       [&](double tol) { return integrate_odeint<odeint::runge_kutta_fehlberg78<Vector>>(f, p, tol); },
       p.tolerances});
  return all;
}

double measure(const Method& m, double tolerance, double least) {
  const double start = thread_seconds();
  int runs = 0;
  do m.run(tolerance), ++runs;
  while (thread_seconds() - start < least);
  return (thread_seconds() - start) / runs;
}

// Rounds in turns over all methods and tolerances; medians.
std::vector<std::vector<Point>> curves(const std::vector<Method>& all, const Problem& p) {
  constexpr int kRounds = 5;
  std::vector<std::vector<std::array<double, kRounds>>> times(all.size());
  std::vector<std::vector<Point>> out(all.size());
  for (size_t m = 0; m < all.size(); ++m) times[m].resize(all[m].tolerances.size());
  for (int round = 0; round < kRounds; ++round) {
    for (size_t m = 0; m < all.size(); ++m) {
      for (size_t k = 0; k < all[m].tolerances.size(); ++k) {
        times[m][k][round] = measure(all[m], all[m].tolerances[k], 2e-3);
      }
    }
  }
  for (size_t m = 0; m < all.size(); ++m) {
    for (size_t k = 0; k < all[m].tolerances.size(); ++k) {
      const double tolerance = all[m].tolerances[k];
      const Vector end = all[m].run(tolerance);
      const double error = end.empty() ? HUGE_VAL : relative_error(end, p.reference);
      out[m].push_back({tolerance, median(times[m][k].data(), kRounds), error});
    }
  }
  return out;
}

// Least time at which the curve reaches the error, infinity where it does not.
double time_at(const std::vector<Point>& curve, double error) {
  double best = HUGE_VAL;
  for (size_t k = 0; k < curve.size(); ++k) {
    const Point& b = curve[k];
    if (!(b.error <= error)) continue;
    double seconds = b.seconds;
    if (k > 0 && curve[k - 1].error > error) {
      const Point& a = curve[k - 1];
      const double w = std::log(a.error / error) / std::log(a.error / b.error);
      seconds = std::exp((1 - w) * std::log(a.seconds) + w * std::log(b.seconds));
    }
    best = std::min(best, seconds);
  }
  return best;
}

enum class Output : uint8_t { comparisons, curves, points };

template <class F>
void compare(const F& f, const Problem& p, Output output) {
  std::vector<Method> all = methods(f, p);
  if (output == Output::points)
    std::erase_if(all, [](const Method& m) { return m.side != Method::Side::ours; });
  const auto measured = curves(all, p);
  if (output == Output::points) {
    for (size_t m = 0; m < all.size(); ++m) {
      for (const Point& q : measured[m]) {
        if (!std::isfinite(q.error)) continue;
        std::printf("{\"problem\": \"%s\", \"method\": \"%s\", \"seconds\": %.6e, \"error\": %.6e}\n",
                    p.name.c_str(), all[m].name.c_str(), q.seconds, q.error);
      }
    }
    return;
  }
  if (output == Output::curves) {
    for (size_t m = 0; m < all.size(); ++m) {
      for (const Point& q : measured[m]) {
        std::fprintf(stderr, "%-10s %-18s %8.0e %10.3f ms  %9.2e\n", p.name.c_str(), all[m].name.c_str(),
                     q.tolerance, 1e3 * q.seconds, q.error);
      }
    }
  }
  for (int e = 2; e <= 12; e += 2) {
    const double error = std::pow(10.0, -e);
    struct Best {
      double seconds = HUGE_VAL;
      std::string name;
    } best[3];
    for (size_t m = 0; m < all.size(); ++m) {
      Best& b = best[static_cast<size_t>(all[m].side)];
      const double t = time_at(measured[m], error);
      if (t < b.seconds) b = {t, all[m].name};
    }
    if (!(best[0].seconds < HUGE_VAL)) continue;
    for (int side = 1; side < 3; ++side) {
      if (!(best[side].seconds < HUGE_VAL)) continue;
      report({.bench = "ode_nonstiff",
              .metric = p.name + ": CPU s at error 1e-" + std::to_string(e) + ", " + best[0].name,
              .ours = best[0].seconds,
              .peer = best[side].seconds,
              .peer_name = best[side].name,
              .error_ours = error,
              .error_peer = error});
    }
  }
}

}  // namespace
}  // namespace truestep::bench

int main(int argc, char** argv) {
  using namespace truestep;
  using namespace truestep::bench;
  Output output = Output::comparisons;
  std::string only;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--curves") output = Output::curves;
    if (word == "--points") output = Output::points;
    if (word == "--problem" && i + 1 < argc) only = argv[++i];
  }
  const auto wanted = [&](const char* name) { return only.empty() || only == name; };
  if (wanted("kepler")) {
    compare(test::kepler_orbit(),
            {"kepler",
             200 * M_PI,
             test::kepler_start(0.6),
             test::kepler_start(0.6),
             1e-3,
             {"dopri5", "tsit5", "dop853", "rkn86", "rkn1210", "ias15"},
             powers(3, 15)},
            output);
  }
  if (wanted("pleiades")) {
    compare(test::pleiades(),
            {"pleiades",
             3,
             test::pleiades_start(),
             test::pleiades_end(),
             1e-4,
             {"dopri5", "tsit5", "dop853", "rkn86", "rkn1210", "ias15"},
             powers(2, 15)},
            output);
  }
  if (wanted("arenstorf")) {
    compare(test::arenstorf(),
            {"arenstorf",
             test::kArenstorfPeriod,
             test::arenstorf_start(),
             test::arenstorf_start(),
             1e-4,
             {"dopri5", "tsit5", "dop853"},
             powers(4, 15)},
            output);
  }
  if (wanted("chain")) {
    const test::Chain chain(1000, 1e6, 1e3);
    compare(chain,
            {"chain",
             10,
             Vector(2000, 0.0),
             chain.exact(10),
             1e-4,
             {"bs32", "dopri5", "tsit5", "dop853", "ssprk104"},
             powers(3, 9)},
            output);
  }
}
