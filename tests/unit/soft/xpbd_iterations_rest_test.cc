// What a body sags by is its stiffness', whether a substep has one iteration or several: multipliers begin
// each substep at zero.
#include <gtest/gtest.h>

#include "tests/support/coupled.h"

namespace truestep {
namespace {

// m, how far a block that is held at one end and pulled along by its weight has become longer.
double stretched(const std::string& block, int iterations) {
  testing_coupled::SceneRun run(R"({"gravity": [9.81, 0, 0], "systems": [{"type": "xpbd", "id": "b", "block":
    {"origin": [0, 0, 0], "size": [0.5, 0.25, 0.25], "cells_x": 2, "cells_y": 1, "cells_z": 1},
    "density": 1000, "pinned": ["x0"], "damping": 20, "substeps": 40, "iterations": )" +
                                std::to_string(iterations) + ", " + block + "}]}");
  run.session.step(120);
  const auto x = run.session.state().systems[0].f64(run.session.state().systems[0].at("position"));
  double most = 0;
  for (size_t k = 0; k < x.size(); k += 3) most = std::max(most, x[k]);
  return most - 0.5;
}

TEST(XpbdIterations, BlocksRestWhereTheirStiffnessSays) {
  for (const char* block :
       {R"("youngs_modulus": 2e4, "poisson_ratio": 0.3)", R"("stiffness": 2000, "bulk_modulus": 2e4)"}) {
    const double one = stretched(block, 1);
    EXPECT_GT(one, 0.01) << "control: it is longer, " << block;
    for (const int iterations : {2, 5}) EXPECT_NEAR(stretched(block, iterations) / one, 1, 0.05) << block;
  }
}

}  // namespace
}  // namespace truestep
