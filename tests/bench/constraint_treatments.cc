// The three treatments of constraints on one chain of ten rods (scenes/constraint_treatments.json), released
// at an angle, for five seconds: CPU time per step, and as the error the widest gap or the energy lost.
// "Ours" is Lagrange multipliers, the peers are springs and projection.
#include <array>
#include <cmath>
#include <string>

#include "engine/systems/rod_chain/rod_chain.h"
#include "tests/bench/report.h"

namespace {

using namespace truestep;
using namespace truestep::rod_chain;
using Treatment = RodChainDef::Treatment;

constexpr int kLinks = 10;

struct Measured {
  double seconds = 0, gap = 0, energy = 0;
};

Measured run(Treatment treatment, double h) {
  RodChainDef d;
  d.constraints = treatment, d.links = kLinks, d.length = 0.15, d.mass = 0.1, d.direction = {1, -1, 0};
  d.substeps = 1;
  BuildContext context;
  context.dt = h;
  // As stiff as the step allows, with a margin of a tenth.
  d.stiffness = 1;
  if (treatment == Treatment::penalty) {
    const double limit = build_rod_chain(&d, context)->limit(Limit::stable_dt, {}, 0).value();
    d.stiffness = 0.81 * (limit / h) * (limit / h);
  }
  const auto system = build_rod_chain(&d, context);
  State s = system->initial_state();
  Workspace workspace;
  ThreadArena arena{1};
  const auto observed = [&](const char* name) {
    Observables out;
    system->observe(s, 0, out);
    return out.find(name).value();
  };
  const double start = observed("energy.total");
  Measured m;
  const auto steps = static_cast<uint64_t>(std::llround(5 / h));
  for (uint64_t k = 0; k < steps; ++k) {
    const double before = bench::thread_seconds();
    system->step(s, {static_cast<double>(k) * h, h, k, workspace, arena});
    m.seconds += bench::thread_seconds() - before;
    m.gap = std::max(m.gap, observed("joints.gap"));
    m.energy = std::max(m.energy, std::abs(observed("energy.total") - start));
  }
  m.seconds /= static_cast<double>(steps);
  return m;
}

}  // namespace

int main() {
  for (const int hertz : {240, 960, 3840}) {
    const double h = 1.0 / hertz;
    const Measured ours = run(Treatment::lagrange, h);
    for (const auto& [treatment, name] :
         {std::pair{Treatment::penalty, "penalty"}, std::pair{Treatment::projection, "projection"}}) {
      const Measured peer = run(treatment, h);
      const std::string at = " at " + std::to_string(hertz) + " Hz";
      bench::report({.bench = "constraint_treatments",
                     .metric = "CPU seconds per step, error: widest gap in m," + at,
                     .ours = ours.seconds,
                     .peer = peer.seconds,
                     .peer_name = name,
                     .error_ours = ours.gap,
                     .error_peer = peer.gap});
      bench::report({.bench = "constraint_treatments",
                     .metric = "CPU seconds per step, error: energy in J," + at,
                     .ours = ours.seconds,
                     .peer = peer.seconds,
                     .peer_name = name,
                     .error_ours = ours.energy,
                     .error_peer = peer.energy});
    }
  }
}
