#include <cmath>

#include "tests/support/coupled.h"

namespace truestep {
namespace {

using namespace testing_coupled;

// A swinging cloth and a cloud of particles, joined at several points; no other forces.
std::string joined(const std::string& attachment) {
  return R"({"gravity": [0, 0, 0], "time": {"dt": 0.002},
    "systems": [
      {"type": "mass_spring", "id": "cloth", "cloth_grid": {"nx": 6, "ny": 5}, "mass": 0.02, "stiffness": 60,
       "velocity": [0.3, -0.2, 0.1], "integrator": "velocity_verlet"},
      {"type": "particles", "id": "dust", "positions": [[0, 0.3, 0], [1, 0.2, 0], [0.5, -0.4, 1]],
       "velocities": [[1, 0, 2], [0, -1, 0], [-2, 1, 1]], "masses": [0.05, 0.5, 0.01]}],
    "couplings": [{"type": "attachment", "id": "j", "a": "cloth", "b": "dust", )" +
         attachment + "}]}";
}

constexpr const char* kLinks[] = {
    R"("link": "spring", "stiffness": 30, "damping": 0.2, "a_points": [0, 5, -1], "b_points": [0, 1, 2])",
    R"("link": "spring", "stiffness": 30, "damping": 0.2, "rest_length": 0, "a_points": [0, 5, 5], "b_points": [0, 0, 2])",
    R"("link": "rigid", "a_points": [0, 5, -1], "b_points": [0, 1, 2])",
    R"("link": "rigid", "a_points": [0, 5, 5], "b_points": [0, 0, 2])"};

TEST(Attachment, KeepsBothMomenta) {
  for (const char* link : kLinks) {
    SceneRun run(joined(link));
    const Sums before = sums(*run.world, run.session.state());
    run.session.step(500);
    const Sums after = sums(*run.world, run.session.state());
    // 500 steps of rounding, 2e-16 each, of sums of this size.
    EXPECT_LT(norm(after.linear - before.linear), 1e-12 * before.scale) << link;
    // A rigid link's correction comes after the systems' last kicks: second order, and small at this step.
    const bool rigid = std::string(link).find("rigid") != std::string::npos;
    EXPECT_LT(norm(after.angular - before.angular), (rigid ? 1e-5 : 1e-12) * before.scale) << link;
    // The control: the momentum of one side alone is far from conserved.
    EXPECT_GT(norm(run.observe3("j.impulse")), 1e-3 * before.scale) << link;
  }
}

TEST(Attachment, RigidLinksKeepTheirLengths) {
  for (const char* link : {kLinks[2], kLinks[3]}) {
    SceneRun run(joined(link));
    double worst = 0;
    for (int i = 0; i < 500; ++i) {
      run.session.step(1);
      worst = std::max(worst, run.observe("j.length.error"));
    }
    EXPECT_LT(worst, 1e-12) << link;
  }
}

// The energy of undamped springs oscillates within a bound; with damping it is what the exchange reports.
TEST(Attachment, DampingTakesWhatTheExchangeReports) {
  SceneRun run(joined(kLinks[0]));
  const double before = run.observe("energy.total");
  run.session.step(1000);
  const double lost = run.observe("j.energy.lost");
  EXPECT_GT(lost, 0.05 * before);
  // The kicks' energy error is second order: (h omega)^2 / 8 with omega < 60 / s.
  EXPECT_NEAR(run.observe("energy.total") + lost, before, 2e-3 * before);
}

TEST(Attachment, LetsGoOfAParticleThatDies) {
  SceneRun run(R"({"time": {"dt": 0.01}, "systems": [
      {"type": "particles", "id": "a", "positions": [[0, 0, 0], [1, 0, 0], [2, 0, 0]],
       "kill_planes": [{"point": [0, -1, 0]}]},
      {"type": "mass_spring", "id": "pin", "free": {"points": [[1, 1, 0], [2, 1, 0]]}, "pins": [0, 1]}],
    "couplings": [{"type": "attachment", "id": "j", "a": "a", "b": "pin", "link": "rigid",
                   "a_points": [1, 2], "b_points": [0, 1]}]})");
  EXPECT_EQ(run.observe("j.pairs"), 2);
  run.session.step(100);
  // The free particle has fallen below the plane; the rows of the others have moved, but their links are
  // intact.
  EXPECT_EQ(run.observe("a.count"), 2);
  EXPECT_EQ(run.observe("j.pairs"), 2);
  EXPECT_LT(run.observe("j.length.error"), 1e-12);
  Command remove;
  remove.kind = CommandKind::remove;
  remove.system = "a";
  remove.index = 0;
  run.session.command(remove);
  EXPECT_EQ(run.observe("j.pairs"), 1);
  run.session.step(10);
  EXPECT_LT(run.observe("j.length.error"), 1e-12);
}

}  // namespace
}  // namespace truestep
