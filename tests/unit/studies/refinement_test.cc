// Convergence in space: known orders are found, at common points, with and without an exact solution.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/scene/catalogue.h"
#include "engine/scene/json/json.h"
#include "engine/studies/refinement/refinement.h"
#include "engine/studies/study.h"

namespace truestep {
namespace {

namespace json = boost::json;

class Refining : public ::testing::Test {
 protected:
  StudyResult run(const std::string& request) {
    return run_study(read_study_request(parse_json(request)), context);
  }
  /// A decaying mode of a rod, with or without its exact solution in the scene.
  static std::string rod(const std::string& more, bool told) {
    const std::string exact = told ? R"j("exact":"exp(-pi^2*t)*sin(pi*x)",)j" : "";
    return R"j({"schema_version":"1.0","name":"rod","time":{"dt":0.001,"duration":0.05},"systems":[
      {"type":"heat","id":"rod","cells":[16],"side":{"kind":"dirichlet"},"initial":"sin(pi*x)",)j" +
           exact + more + "}]}";
  }
  static std::string convergence(const std::string& scene, const std::string& rest) {
    return R"({"kind":"convergence","scene":)" + scene + "," + rest + "}";
  }
  Error refused(const std::string& request) {
    try {
      run(request);
    } catch (const Error& e) {
      return e;
    }
    ADD_FAILURE() << "accepted: " << request;
    return Error("none", "");
  }
  ThreadArena arena{1};
  std::atomic<bool> cancelled{false};
  StudyContext context{.arena = arena, .cancelled = cancelled, .progress = [](double, const std::string&) {}};
};

TEST_F(Refining, FindsTheOrderInSpaceWithAndWithoutAnExactSolution) {
  for (const bool told : {true, false}) {
    for (const int order : {2, 4}) {
      const auto r = run(convergence(rod("\"order\":\"" + std::to_string(order) + '"', told),
                                     R"("refine":"space","budget":20)"));
      ASSERT_TRUE(r.summary.at("observed_order").is_double()) << json::serialize(r.summary);
      // The next term of the error is (pi dx)^2 times the first: below 0.04 from 16 cells on.
      EXPECT_NEAR(r.summary.at("observed_order").as_double(), order, 0.05) << told;
      EXPECT_EQ(r.summary.at("promised_order").as_int64(), order);
      EXPECT_EQ(r.summary.at("subject").as_string(), "rod.cells");
    }
  }
}

TEST_F(Refining, GalleryScenesHaveTheOrderOfTheirSystem) {
  const auto order = [&](const std::string& rest) {
    const auto r = run(R"({"kind":"convergence","refine":"space",)" + rest + "}");
    EXPECT_TRUE(r.summary.at("observed_order").is_double()) << json::serialize(r.summary);
    const json::value& observed = r.summary.at("observed_order");
    return observed.is_double() ? observed.as_double() : NAN;
  };
  // Measured 4.01 and 2.00. The string's two pulses are still travelling: after a whole crossing every mode
  // has advanced by a multiple of pi, so that phase errors would enter squared, as order 4.
  EXPECT_NEAR(order(R"("gallery":"heat_plate","horizon":0.005,"halvings":3)"), 4, 0.1);
  EXPECT_NEAR(order(R"("gallery":"wave_string","horizon":0.7,"halvings":5)"), 2, 0.1);
}

// Particles of different resolutions have different positions; errors against an exact solution need no
// common ones. A block swells in one direction between walls in a known way, by a manufactured force.
TEST_F(Refining, ParticlesOfMaterialHaveAnOrderAgainstAnExactSolution) {
  const std::string scene = R"j({"schema_version":"1.0","name":"swell","gravity":[0,0,0],
    "time":{"dt":0.001,"duration":0.25},"systems":[{"type":"mpm","id":"block","low":[0,0,0],"high":[1,0.5,1],
    "cell":0.03125,"precision":"f64","walls":"slip","transfer":"flip","flip":1,"bodies":[{"center":[0.5,0.25,0],
    "half_extents":[0.5,0.25,1],"youngs_modulus":1000,"poisson_ratio":0,"density":1000}],
    "force":["1e-5*2*pi^2*(sin(pi*x)^2*cos(2*pi*t)-cos(2*pi*x)*(1-cos(2*pi*t))/2)","0"],
    "exact":["x+1e-5*sin(pi*x)^2*(1-cos(2*pi*t))/2","y"]}]})j";
  const auto r = run(convergence(scene, R"("refine":"space","budget":20,"halvings":3)"));
  ASSERT_EQ(r.table.rows.size(), 4u) << json::serialize(r.summary);
  EXPECT_EQ(r.summary.at("subject").as_string(), "block.cell");
  EXPECT_EQ(r.summary.at("measured_against").as_string(), "the scene's exact solution");
  // Second order, as quadratic splines between slip walls without strain promise; the time steps add a
  // twentieth to the error of the third level and a fifth to that of the fourth. Measured 1.91 and 2.03.
  for (const size_t row : {1u, 2u})
    EXPECT_NEAR(std::get<double>(r.table.rows[row][5]), 2, 0.15) << json::serialize(r.summary);
}

TEST_F(Refining, TheLimitOfEverFinerOnesIsTheExactSolution) {
  // Errors against the limit of the finest resolutions equal those against the exact solution.
  const auto told = run(convergence(rod(R"("order":"2")", true), R"("refine":"space","budget":20)"));
  const auto found = run(convergence(rod(R"("order":"2")", false), R"("refine":"space","budget":20)"));
  // Norms over the nodes of four and eight cells differ from those over the rod.
  for (size_t k = 2; k < told.table.rows.size(); ++k) {
    const double a = std::get<double>(told.table.rows[k][4]), b = std::get<double>(found.table.rows[k][4]);
    EXPECT_NEAR(b / a, 1, 0.05) << k;
  }
}

TEST_F(Refining, BothFollowsTheSpacingAsTheMethodNeedsIt) {
  // Order 1 in time with dt ~ dx^2, order 2 with dt ~ dx, and rk4, whose stability limit falls like dx^2.
  for (const auto& [name, follows, order] :
       {std::tuple{"euler", "dx^2", 2}, {"trapezoid", "dx", 2}, {"rk4", "dx^2", 2}}) {
    const auto r =
        run(convergence(rod(R"("order":"2")", true),
                        R"("refine":"both","budget":20,"integrator":")" + std::string(name) + '"'));
    EXPECT_EQ(r.summary.at("step_follows").as_string(), follows) << name;
    ASSERT_TRUE(r.summary.at("observed_order").is_double()) << json::serialize(r.summary);
    EXPECT_NEAR(r.summary.at("observed_order").as_double(), order, 0.1) << name;
  }
}

TEST_F(Refining, ASceneThatHasNoResolutionSaysWhatHas) {
  const std::string oscillator = R"({"schema_version":"1.0","name":"o","time":{"dt":0.01,"duration":1},
    "systems":[{"type":"oscillator","id":"o","mass":1,"stiffness":100,"position":1}]})";
  const Error e = refused(convergence(oscillator, R"("refine":"space")"));
  EXPECT_EQ(e.code(), "scene_invalid");
  EXPECT_EQ(e.issues().at(0).pointer, "/refine");
  for (const char* has : {"heat (cells)", "wave (cells)", "mass_spring (", "xpbd (", "rod_chain (links)"})
    EXPECT_THAT(e.issues().at(0).allowed, ::testing::HasSubstr(has));
  const Error method =
      refused(convergence(rod(R"("order":"2")", true), R"("refine":"space","integrator":"rk4")"));
  EXPECT_EQ(method.issues().at(0).pointer, "/integrator");
}

TEST_F(Refining, WorkPrecisionRunsOverResolution) {
  const auto r = run(R"({"kind":"work_precision","scene":)" + rod(R"("order":"2")", false) +
                     R"(,"refine":"both","integrators":["trapezoid","rkc2","velocity_verlet"],"budget":20})");
  std::map<std::string, std::vector<double>> errors;
  for (const auto& row : r.table.rows)
    errors[std::get<std::string>(row[0])].push_back(std::get<double>(row[4]));
  // A heat equation has no velocities.
  EXPECT_EQ(r.summary.at("refused").as_array().size(), 1u);
  ASSERT_EQ(errors.size(), 2u);
  for (const auto& [name, e] : errors) {
    ASSERT_GE(e.size(), 4u) << name;
    EXPECT_NEAR(e[e.size() - 2] / e.back(), 4, 1) << name;
  }
}

// The same object at twice the resolution: total mass, stiffness and damping are preserved.
TEST_F(Refining, ARopeStaysTheSameRope) {
  const std::string rope = R"({"schema_version":"1.0","name":"rope","gravity":[0,-10,0],
    "time":{"dt":0.01,"duration":0.2},"systems":[{"type":"mass_spring","id":"r","density":0.5,"stiffness":4000,
    "internal_damping":2,"pinned":["first"],"rope":{"from":[0,0,0],"to":[0,-1,0],"links":8}}]})";
  const Refinement ladder(parse_json(rope), "", context);
  EXPECT_EQ(ladder.coarsening(), 4);
  const json::value coarse = ladder.document(0), fine = ladder.document(3);
  const auto at = [](const json::value& d, const char* key) {
    return d.at("systems").at(0).at(key).as_double();
  };
  EXPECT_EQ(coarse.at("systems").at(0).at("rope").at("links").to_number<int>(), 2);
  EXPECT_EQ(fine.at("systems").at(0).at("rope").at("links").to_number<int>(), 16);
  // One over the sum of 1 / k over the links.
  EXPECT_EQ(at(coarse, "stiffness") / 2, at(fine, "stiffness") / 16);
  EXPECT_EQ(at(coarse, "internal_damping") / 2, at(fine, "internal_damping") / 16);
  const auto r = run(convergence(rope, R"("refine":"space","budget":20)"));
  ASSERT_GE(r.table.rows.size(), 4u);
  // It sags by rho g L^2 / (2 E A) at any resolution: errors fall.
  EXPECT_LT(std::get<double>(r.table.rows[3][4]), 0.5 * std::get<double>(r.table.rows[1][4]));
  // Points of a given mass: more of them are a heavier rope.
  std::string heavier = rope;
  heavier.replace(heavier.find("\"density\":0.5"), 13, "\"mass\":0.01");
  EXPECT_THAT(refused(convergence(heavier, R"("refine":"space")")).what(), ::testing::HasSubstr("density"));
}

// The same for position-based ropes, sheets and blocks: by hand from the springs in series and in parallel.
TEST_F(Refining, PositionBasedShapesStayTheSame) {
  const auto system = [&](const std::string& more, int level) {
    const std::string scene = R"({"schema_version":"1.0","name":"x","time":{"dt":0.01,"duration":0.02},
      "systems":[{"type":"xpbd","id":"x","density":0.5,"damping":0.08,"internal_damping":2,)" +
                              more + "}]}";
    return Refinement(parse_json(scene), "", context).document(level).at("systems").at(0);
  };
  const auto number = [](const json::value& v, const char* key) { return v.at(key).to_number<double>(); };
  const auto count = [](const json::value& v, const char* shape, const char* key) {
    return v.at(shape).at(key).to_number<int>();
  };
  const std::string rope = R"("stiffness":4000,"rope":{"from":[0,0,0],"to":[0,-1,0],"links":8})";
  EXPECT_EQ(count(system(rope, 0), "rope", "links"), 2);
  EXPECT_EQ(count(system(rope, 3), "rope", "links"), 16);
  EXPECT_EQ(number(system(rope, 3), "stiffness"), 8000);
  EXPECT_EQ(number(system(rope, 3), "internal_damping"), 4);
  EXPECT_EQ(number(system(rope, 3), "damping"), 0.04);
  const std::string cloth =
      R"("stiffness":4000,"cloth_grid":{"origin":[0,0,0],"edge_u":[1,0,0],"edge_v":[0,0,1],"nx":9,"ny":17})";
  EXPECT_EQ(count(system(cloth, 3), "cloth_grid", "nx"), 17);
  EXPECT_EQ(count(system(cloth, 3), "cloth_grid", "ny"), 33);
  EXPECT_EQ(number(system(cloth, 3), "stiffness"), 4000);
  EXPECT_EQ(number(system(cloth, 3), "damping"), 0.02);
  const std::string block =
      R"("stiffness":4000,"block":{"size":[1,1,1],"cells_x":4,"cells_y":4,"cells_z":8})";
  EXPECT_EQ(count(system(block, 3), "block", "cells_z"), 16);
  EXPECT_EQ(number(system(block, 3), "stiffness"), 2000);
  EXPECT_EQ(number(system(block, 3), "damping"), 0.01);
}

// A rope that stretches under its weight, against the finest: measured 3.8e-4, 1.1e-4 and 2.2e-5, by substeps
// of the same length at all resolutions.
TEST_F(Refining, APositionBasedRopeConverges) {
  const std::string rope = R"({"schema_version":"1.0","name":"rope","gravity":[0,-10,0],
    "time":{"dt":0.01,"duration":0.2},"systems":[{"type":"xpbd","id":"r","density":0.5,"stiffness":4000,
    "internal_damping":2,"pinned":["first"],"rope":{"from":[0,0,0],"to":[0,-1,0],"links":8}}]})";
  const auto r = run(convergence(rope, R"("refine":"space","budget":20,"halvings":3)"));
  EXPECT_EQ(r.table.rows.size(), 4u) << json::serialize(r.summary);
  EXPECT_LT(std::get<double>(r.table.rows[2][4]), 0.1 * std::get<double>(r.table.rows[0][4]))
      << json::serialize(r.summary);
}

TEST_F(Refining, WhatBelongsToPointsOfAClothIsNamed) {
  const auto why = [&](const std::string& more) {
    return std::string(
        refused(convergence(R"({"schema_version":"1.0","name":"c","time":{"dt":0.01,"duration":0.02},
      "systems":[{"type":"xpbd","id":"c",)" +
                                more + R"("rope":{"from":[0,0,0],"to":[0,-1,0],"links":8}}]})",
                            R"("refine":"space","budget":5)"))
            .what());
  };
  EXPECT_THAT(why(R"("mass":0.1,)"), ::testing::HasSubstr("density"));
  EXPECT_THAT(why(R"("density":1,"scheme":"pbd",)"), ::testing::HasSubstr("use xpbd"));
  EXPECT_THAT(why(R"("density":1,"pins":[3],)"), ::testing::HasSubstr("pinned"));
  EXPECT_THAT(why(R"("density":1,"loads":[{"point":8,"mass":1}],)"), ::testing::HasSubstr("loads"));
}

// Rods of half the length with half the mass: their ends approach a thread that swings down. Compared are the
// ends that all resolutions share, as no centres are shared. Measured 0.033, 0.015 and 0.0040.
TEST_F(Refining, AChainOfRodsBecomesAThread) {
  const std::string chain = R"({"schema_version":"1.0","name":"chain","gravity":[0,-10,0],
    "time":{"dt":0.01,"duration":0.2},"systems":[{"type":"rod_chain","id":"c","links":8,"length":0.125,
    "mass":0.25}]})";
  const Refinement ladder(parse_json(chain), "", context);
  const json::value fine = ladder.document(3).at("systems").at(0);
  EXPECT_EQ(fine.at("links").to_number<int>(), 16);
  EXPECT_EQ(fine.at("length").as_double(), 0.0625);
  EXPECT_EQ(fine.at("mass").as_double(), 0.125);
  const auto r = run(convergence(chain, R"("refine":"space","budget":20,"halvings":3)"));
  EXPECT_EQ(r.summary.at("subject").as_string(), "c.links");
  ASSERT_EQ(r.table.rows.size(), 4u) << json::serialize(r.summary);
  for (const size_t row : {1u, 2u}) {
    EXPECT_LT(std::get<double>(r.table.rows[row][4]), 0.6 * std::get<double>(r.table.rows[row - 1][4]))
        << json::serialize(r.summary);
  }
  EXPECT_EQ(refused(convergence(chain, R"("refine":"space","quantity":"position","budget":5)"))
                .issues()
                .at(0)
                .pointer,
            "/quantity");
}

// A square that slides along two of its sides under a load that is even except for a smooth bump: no corner
// reduces the second order that positions have on smooth solutions.
std::string square(const std::string& element, int cells) {
  const std::string n = std::to_string(cells);
  return R"j({"schema_version":"1.0","name":"square","gravity":[0,0,0],"time":{"dt":1,"duration":1},"systems":[
      {"type":"fem","id":"body","element":")j" +
         element + R"j(","quad":{"cells_x":)j" + n + R"j(,"cells_y":)j" + n +
         R"j(},"material":"linear","youngs_modulus":1000,"poisson_ratio":0.3,"motion":"quasi_static",
       "holds":[{"on":"x0","x":"0"},{"on":"y0","y":"0"}],"loads":[{"on":"x1","x":"1+cos(2*pi*Y)"}]}]})j";
}

TEST_F(Refining, ElementsHaveTheirOrder) {
  const auto r = run(convergence(square("quad4", 64), R"("refine":"space","budget":45)"));
  ASSERT_TRUE(r.summary.at("observed_order").is_double()) << json::serialize(r.summary);
  EXPECT_NEAR(r.summary.at("observed_order").as_double(), 2, 0.05);
}

// On meshes this coarse, corners still reduce the order: the rest tells linear from quadratic elements.
TEST_F(Refining, QuadraticElementsHaveAHigherOrder) {
  const auto finest = [&](const std::string& element, int cells) {
    const auto r = run(convergence(square(element, cells), R"("refine":"space","halvings":4,"budget":20)"));
    const auto& columns = r.table.columns;
    const auto order = static_cast<size_t>(
        std::ranges::find(columns, "observed_order", [](const auto& c) { return c.name; }) - columns.begin());
    double last = 0;
    for (const auto& row : r.table.rows) {
      if (const double* p = std::get_if<double>(&row[order]); p && std::isfinite(*p)) last = *p;
    }
    return last;
  };
  EXPECT_NEAR(finest("tri3", 16), 2, 0.15);
  for (const char* element : {"tri6", "quad9"}) {
    EXPECT_GT(finest(element, 8), 2.4) << element;
    EXPECT_LT(finest(element, 8), 3.5) << element;
  }
}

TEST_F(Refining, BodiesOfGivenCellsAreNotDivided) {
  const Error e = refused(
      convergence(R"j({"schema_version":"1.0","name":"one","time":{"dt":0.01,"duration":0.1},"systems":[
    {"type":"fem","id":"body","mesh":{"vertices":[[0,0,0],[1,0,0],[0,1,0]],"cells":[0,1,2]},"element":"tri3"}]})j",
                  R"("refine":"space","budget":5)"));
  ASSERT_FALSE(e.issues().empty());
  EXPECT_EQ(e.issues()[0].pointer, "/refine");
}

// A cloth whose bending springs are defined by their number cannot be refined: this is reported before its
// first resolution is integrated, which takes minutes for the gallery's.
TEST_F(Refining, WhatCannotBeDividedIsRefusedBeforeAnythingRuns) {
  int begun = 0;
  context.progress = [&](double, const std::string&) { ++begun; };
  const Error e = refused(
      convergence(R"j({"schema_version":"1.0","name":"cloth","time":{"dt":0.01,"duration":0.02},"systems":[
    {"type":"mass_spring","id":"cloth","density":0.2,"bending_stiffness":2,"pinned":["corner_00"],
     "cloth_grid":{"origin":[0,0,0],"edge_u":[1,0,0],"edge_v":[0,0,1],"nx":4,"ny":4}}]})j",
                  R"("refine":"space","budget":5)"));
  EXPECT_THAT(e.what(), ::testing::HasSubstr("bending_rigidity"));
  EXPECT_EQ(begun, 0);
}

// A bore is one or two cells wide: the mean error falls with the cells, first order at every halving. In the
// mean square, where the position of a front within its cell matters most, the two runs in time differ by
// more than that, and no order was found. The bounds leave room for the position of the bore in its cell.
TEST_F(Refining, AFrontHasFirstOrderInTheMean) {
  const auto r = run(R"({"kind":"convergence","refine":"space","gallery":"stoker_dam_break","budget":30})");
  const auto column = [&](const std::string& name) {
    return static_cast<size_t>(
        std::ranges::find(r.table.columns, name, [](const auto& c) { return c.name; }) -
        r.table.columns.begin());
  };
  const size_t order = column("observed_order");
  int orders = 0;
  for (const auto& row : r.table.rows) {
    const double* p = std::get_if<double>(&row[order]);
    if (!p || !std::isfinite(*p)) continue;
    ++orders;
    EXPECT_NEAR(*p, 1, 0.3);
  }
  EXPECT_GE(orders, 3);
}

}  // namespace
}  // namespace truestep
