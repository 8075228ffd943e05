#include "tests/bench/ode/problems.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "tests/bench/ode/odeint.h"
#include "tests/support/ode_problems.h"
#include "tests/support/stiff_problems.h"

namespace truestep::bench {
namespace {

// Cases keep their addresses: solvers hold references.
Case& keep(Case at) {
  static std::deque<Case> all;
  return all.emplace_back(std::move(at));
}

Case against(const char* name, double t_end, Vector start, const Vector& reference, double first_step) {
  return {.name = name,
          .t_end = t_end,
          .start = std::move(start),
          .first_step = first_step,
          .error = [reference](const double* y) {
            return test::relative_error({y, y + reference.size()}, reference);
          }};
}

Case against(const char* name, const test::StiffCase& c, double first_step) {
  return {.name = name,
          .t_end = c.t_end,
          .start = c.y0,
          .first_step = first_step,
          .absolute_scale = c.absolute_scale,
          .error = [c](const double* y) { return c.error(y); }};
}

/// Every explicit solver: methods of ours by name, odeint's two, CVODE Adams.
template <class F>
Problem smooth(const F& f, Case at, const std::vector<const char*>& methods, int from) {
  const Case& kept = keep(std::move(at));
  Problem p{kept, {}};
  for (const char* name : methods) p.solvers.push_back(ours(name, f, kept, from, 15));
  p.solvers.push_back(odeint_dopri5(f, kept, from, 12));
  p.solvers.push_back(odeint_fehlberg78(f, kept, from, 13));
  p.solvers.push_back(cvode_adams(f, kept, from, 13));
  return p;
}

/// Small stiff systems.
template <class F>
Problem stiff(const F& f, Case at) {
  const Case& kept = keep(std::move(at));
  return {kept,
          {ours("rodas5p", f, kept, 2, 12), ours("radau5", f, kept, 2, 12), cvode_bdf(f, kept, 3, 13),
           odeint_rosenbrock4(f, kept, 2, 10)}};
}

Problem beam() {
  static const test::Beam f;
  const auto published = test::Beam::published();
  const Case& at = keep({.name = "beam",
                         .t_end = published.t_end,
                         .start = published.y0,
                         .first_step = 1e-6,
                         .error = [published](const double* y) {
                           const auto got = test::Beam::picked(y);
                           double worst = 0;
                           for (size_t i = 0; i < got.size(); ++i) {
                             worst = std::max(worst, std::abs(got[i] - published.reference[i]));
                           }
                           return worst;
                         }});
  return {at,
          {ours("rodas5p", f, at, 2, 9), ours("radau5", f, at, 2, 9), ours("dop853", f, at, 2, 9),
           cvode_bdf(f, at, 4, 9), odeint_rosenbrock4(f, at, 2, 6), odeint_dopri5(f, at, 3, 9)}};
}

Problem chain(const char* name, double k, double c) {
  static std::deque<test::Chain> all;
  const test::Chain& f = all.emplace_back(1000, k, c);
  Case& at = keep(against(name, f.fall(10), 1e-4));
  at.stiffness = k, at.damping = c;
  Problem p{at, {ours("rodas5p", f, at, 2, 9), ours("radau5", f, at, 2, 9), cvode_chain(at, 3, 9)}};
  if (k < 1e7) {
    for (const char* method : {"tsit5", "dop853", "ssprk104"}) {
      p.solvers.push_back(ours(method, f, at, 3, 10));
    }
    p.solvers.push_back(odeint_dopri5(f, at, 3, 10));
    p.solvers.push_back(odeint_fehlberg78(f, at, 3, 9));
  } else {
    // Limited by stability, so one tolerance is enough: a run takes half a minute.
    p.solvers.push_back(odeint_dopri5(f, at, 4, 4));
  }
  return p;
}

}  // namespace

std::vector<Problem> problems() {
  static const auto kepler = test::kepler_orbit();
  static const auto pleiades = test::pleiades();
  static const auto arenstorf = test::arenstorf();
  static const test::Hires hires;
  static const test::Rober rober;
  static const test::VanDerPol vdpol;
  const std::vector<const char*> positions = {"tsit5", "dop853", "rkn86", "rkn1210", "ias15"};
  const Vector orbit = test::kepler_start(0.6), loop = test::arenstorf_start();
  std::vector<Problem> all;
  all.push_back(smooth(kepler, against("kepler", 200 * M_PI, orbit, orbit, 1e-3), positions, 4));
  all.push_back(smooth(pleiades, against("pleiades", 3, test::pleiades_start(), test::pleiades_end(), 1e-4),
                       positions, 2));
  all.push_back(smooth(arenstorf, against("arenstorf", test::kArenstorfPeriod, loop, loop, 1e-4),
                       {"dopri5", "tsit5", "dop853"}, 4));
  all.push_back(stiff(hires, against("hires", test::Hires::published(), 1e-6)));
  all.push_back(stiff(rober, against("rober", test::Rober::published(), 1e-8)));
  all.push_back(stiff(vdpol, against("vdpol", test::VanDerPol::published(), 1e-6)));
  all.push_back(beam());
  all.push_back(chain("chain_1e6", 1e6, 1e3));
  all.push_back(chain("chain_1e8", 1e8, 1e5));
  return all;
}

}  // namespace truestep::bench
