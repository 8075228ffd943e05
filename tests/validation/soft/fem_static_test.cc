// Finite element bodies in equilibrium against closed forms and reference values of the literature. Each
// tolerance is that of the discretization at hand, unless stated otherwise.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/unit/fem/fem_rig.h"

namespace truestep::fem {
namespace {

using testing_rig::FemRun;

FemDef still(Law law, double e, double nu) {
  FemDef d;
  d.material = law, d.youngs_modulus = e, d.poisson_ratio = nu;
  d.motion = Motion::quasi_static;
  return d;
}

constexpr Cell kPlaneCells[] = {Cell::tri3, Cell::tri6, Cell::quad4, Cell::quad9};
constexpr Cell kSolidCells[] = {Cell::tet4, Cell::tet10, Cell::hex8, Cell::hex27};

// A lattice with displaced inner corners, as a mesh.
CellsShape shaken(Cell cell) {
  FemDef d;
  const bool plane = element_of(kind_of(cell)).dimension == 2;
  const bool simplex = element_of(kind_of(cell)).simplex;
  if (plane) {
    d.quad = QuadShape{.cells_x = 3, .cells_y = 3};
    d.element = simplex ? Cell::tri3 : Cell::quad4;
  } else {
    d.block = SoftBlockShape{.cells_x = 3, .cells_y = 3, .cells_z = 3};
    d.element = simplex ? Cell::tet4 : Cell::hex8;
  }
  const Mesh mesh = build_mesh(d);
  CellsShape out{mesh.x, {mesh.nodes.begin(), mesh.nodes.end()}};
  std::vector<uint8_t> border(mesh.x.size());
  for (const uint32_t p : mesh.find("border")->nodes) border[p] = 1;
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> spread(-0.05, 0.05);
  for (size_t p = 0; p < border.size(); ++p) {
    if (!border[p]) out.vertices[p] += Vec3{spread(engine), spread(engine), plane ? 0 : spread(engine)};
  }
  return out;
}

// fem.patch: displacements that are affine on the boundary are affine inside, for any element, any law, any
// mesh.
TEST(FemStatic, AffineDisplacementsAreExactOnIrregularMeshes) {
  for (const auto& cells : {kPlaneCells, kSolidCells}) {
    for (size_t c = 0; c < 4; ++c) {
      const Cell cell = cells[c];
      const bool plane = element_of(kind_of(cell)).dimension == 2;
      for (const Law law : {Law::linear, Law::neo_hookean}) {
        FemDef d = still(law, 1000, 0.3);
        d.mesh = shaken(cell), d.element = cell;
        d.holds = {{"border", "0.04*X - 0.03*Y + 0.01", "0.05*X + 0.02*Y", {}}};
        if (!plane) d.holds[0].z = "0.02*X - 0.04*Z";
        FemRun run(d);
        run.step();
        double worst = 0, quadratic = 0;
        for (size_t i = 0; i < run.system->body().mesh.x.size(); ++i) {
          const Vec3 x = run.system->body().mesh.x[i];
          const Vec3 want{0.04 * x.x - 0.03 * x.y + 0.01, 0.05 * x.x + 0.02 * x.y,
                          plane ? 0 : 0.02 * x.x - 0.04 * x.z};
          worst = std::max(worst, norm(run.displacement(i) - want));
        }
        EXPECT_LT(worst, 1e-10) << element_of(kind_of(cell)).name << ' ' << static_cast<int>(law);
        // The control: quadratic ones are not, where interpolating boundary values does not give the
        // interior.
        d.holds[0].x = "0.5*X*X*Y";
        FemRun other(d);
        other.step();
        for (size_t i = 0; i < other.system->body().mesh.x.size(); ++i) {
          const Vec3 x = other.system->body().mesh.x[i];
          quadratic = std::max(quadratic, std::abs(other.displacement(i).x - 0.5 * x.x * x.x * x.y));
        }
        EXPECT_GT(quadratic, 1e-6);
      }
    }
  }
}

// fem.bar_gravity: rho g L^2 / 2 E, nu = 0; nodes of linear elements are exact in one dimension.
TEST(FemStatic, ABarHangsAsLongAsItsWeightMakesIt) {
  for (const Cell cell : kSolidCells) {
    FemDef d = still(Law::linear, 1e5, 0);
    d.block = SoftBlockShape{.size = {0.1, 1, 0.1}, .cells_x = 1, .cells_y = 10, .cells_z = 1};
    d.element = cell, d.density = 1000, d.pinned = {"top"};
    FemRun run(d, 1, {0, -9.81, 0});
    run.step();
    const double tip = -run.displacement_at({0.05, 0, 0.05}).y;
    EXPECT_NEAR(tip, 0.04905, 0.001 * 0.04905) << element_of(kind_of(cell)).name;
    EXPECT_NEAR(run.observe("reaction.y"), 1000 * 0.01 * 9.81, 1e-6);
  }
}

// fem.uniaxial_nh: one element in uniaxial stress, closed form with 30 digits.
TEST(FemStatic, OneElementHasTheNeoHookeanClosedForm) {
  for (const auto& [stretch, lateral, nominal] :
       {std::array{0.5, 1.21076739052332292, -0.935352056888197503},
        std::array{0.8, 1.06733836927896849, -0.240005381988022936},
        std::array{1.5, 0.880174591806737791, 0.378280176394318592}}) {
    for (const Volume volume : {Volume::pointwise, Volume::mean}) {
      FemDef d = still(Law::neo_hookean, 1, 0.3);
      d.block = SoftBlockShape{.cells_x = 1, .cells_y = 1, .cells_z = 1};
      d.element = Cell::hex8, d.volume = volume;
      d.holds = {{"x0", "0", {}, {}},
                 {"y0", {}, "0", {}},
                 {"z0", {}, {}, "0"},
                 {"x1", std::to_string(stretch - 1), {}, {}}};
      FemRun run(d);
      run.step();
      const size_t far = run.node_at({1, 1, 1});
      EXPECT_NEAR(1 + run.displacement(far).y, lateral, 1e-9);
      EXPECT_NEAR(1 + run.displacement(far).z, lateral, 1e-9);
      // On both ends: equal and opposite; the force on x1 is that of the elements at its nodes.
      std::vector<double> f(3 * run.system->body().mesh.x.size());
      Evaluation e{run.workspace, run.arena};
      run.system->elements().elastic_forces({0, run.state.f64(0), run.state.f64(1), run.state}, f, e);
      double force = 0;
      for (const uint32_t p : run.system->body().mesh.find("x1")->nodes) force -= f[3 * p];
      EXPECT_NEAR(force, nominal, 1e-9);
    }
  }
}

FemDef cook(Law law, double e, double nu, double shear, int cells, Cell cell) {
  FemDef d = still(law, e, nu);
  d.quad = QuadShape{{{0, 0, 0}, {48, 44, 0}, {48, 60, 0}, {0, 44, 0}}, cells, cells};
  d.element = cell;
  d.pinned = {"x0"};
  d.loads = {{"x1", Vec3{0, shear, 0}, {}, {}, {}, {}}};
  return d;
}

// fem.cook_linear: plane stress, E = 1, nu = 1/3; the same series of scikit-fem's quadratic elements.
TEST(FemStatic, CooksMembraneIsThatOfTheLiterature) {
  for (const auto& [cells, reference] : {std::pair{8, 23.92539}, {16, 23.94941}}) {
    FemDef d = cook(Law::linear, 1, 1.0 / 3, 1, cells, Cell::quad9);
    d.plane = Plane::stress;
    FemRun run(d);
    run.step();
    EXPECT_NEAR(run.displacement_at({48, 52, 0}).y, reference, 2e-5) << cells;
    d.plane = Plane::strain;
    FemRun control(d);
    control.step();
    EXPECT_GT(std::abs(control.displacement_at({48, 52, 0}).y - reference), 1);
  }
  // Others come as near as 1 % of 23.968 with 32 cells, but for the linear triangle.
  for (const auto& [cell, tolerance] :
       {std::pair{Cell::quad4, 0.01}, {Cell::tri6, 0.003}, {Cell::tri3, 0.03}}) {
    FemDef d = cook(Law::linear, 1, 1.0 / 3, 1, 32, cell);
    d.plane = Plane::stress;
    FemRun run(d);
    run.step();
    EXPECT_NEAR(run.displacement_at({48, 52, 0}).y, 23.968, tolerance * 23.968)
        << element_of(kind_of(cell)).name;
  }
}

// fem.cook_neohooke: plane strain, E = 200, nu = 0.35, shear 4 x 16; series of quadratic elements for the
// logarithmic form.
TEST(FemStatic, CooksMembraneOfRubberIsThatOfTheLiterature) {
  for (const auto& [cells, reference] : {std::pair{8, 6.10023}, {16, 6.12846}}) {
    FemRun run(cook(Law::neo_hookean, 200, 0.35, 64, cells, Cell::quad9));
    run.step();
    EXPECT_NEAR(run.displacement_at({48, 60, 0}).y, reference, 2e-5) << cells;
  }
  FemRun control(cook(Law::st_venant_kirchhoff, 200, 0.35, 64, 8, Cell::quad9));
  control.step();
  EXPECT_GT(std::abs(control.displacement_at({48, 60, 0}).y - 6.10023), 0.05);
}

// Nearly incompressible, nu = 0.4999: with the mean volume linear elements converge; without it they are far
// too stiff for any number of cells.
TEST(FemStatic, NearlyIncompressibleBodiesDoNotLock) {
  const auto tip = [](Cell cell, Volume volume, int cells) {
    FemDef d = cook(Law::neo_hookean, 240.565, 0.4999, 100, cells, cell);
    d.volume = volume;
    FemRun run(d);
    run.step();
    return run.displacement_at({48, 60, 0}).y;
  };
  const double fine = tip(Cell::quad9, Volume::mean, 16);
  const double coarse = tip(Cell::quad4, Volume::mean, 8), middle = tip(Cell::quad4, Volume::mean, 16),
               near = tip(Cell::quad4, Volume::mean, 32);
  EXPECT_NEAR(tip(Cell::tri6, Volume::mean, 8), fine, 0.02 * fine);
  EXPECT_NEAR(near, fine, 0.02 * fine);
  EXPECT_LT(std::abs(near - fine), std::abs(middle - fine));
  EXPECT_LT(std::abs(middle - fine), std::abs(coarse - fine));
  EXPECT_LT(tip(Cell::quad4, Volume::pointwise, 16), 0.8 * fine);
}

// fem.timoshenko: P = 1000, L = 48, D = 12, E = 3e7, nu = 0.3; root displaced and end loaded as in the
// solution, which quadratic elements then approximate to 0.1 %.
TEST(FemStatic, TimoshenkosCantileverBendsAsItsSolution) {
  FemDef d = still(Law::linear, 3e7, 0.3);
  d.quad = QuadShape{{{0, -6, 0}, {48, -6, 0}, {48, 6, 0}, {0, 6, 0}}, 24, 6};
  d.element = Cell::quad9, d.plane = Plane::stress;
  // At x = 0, for a load downwards: u_x = P y (2 + nu)(y^2 - D^2 / 4) / 6 E I, u_y = -P nu y^2 L / 2 E I.
  const double inertia = 12.0 * 12 * 12 / 12, k = 1000 / (6 * 3e7 * inertia);
  const auto number = [](double v) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", v);
    return std::string(text);
  };
  d.holds = {{"x0", number(2.3 * k) + "*Y*(Y*Y - 36)", number(-0.9 * 48 * k) + "*Y*Y", {}}};
  d.loads = {{"x1", {}, {}, "-1000/288*(36 - Y*Y)", {}, {}}};
  FemRun run(d);
  run.step();
  EXPECT_NEAR(run.displacement_at({48, 0, 0}).y, -0.0089, 1e-3 * 0.0089);
  d.plane = Plane::strain;
  FemRun control(d);
  control.step();
  EXPECT_GT(std::abs(control.displacement_at({48, 0, 0}).y + 0.0089), 0.01 * 0.0089);
}

// fem.turek_csm: the bar behind a cylinder, its root the cylinder's arc. 0.5 % with 35 x 2 quadratic
// elements.
TEST(FemStatic, TureksBarBendsAsPublished) {
  for (const auto& [mu, ux, uy] :
       {std::array{0.5e6, -7.18777e-3, -66.1029e-3}, {2e6, -0.469006e-3, -16.9740e-3}}) {
    FemDef d = still(Law::st_venant_kirchhoff, 2 * 1.4 * mu, 0.4);
    d.density = 1000;
    constexpr int kNx = 36, kNy = 4;
    CellsShape mesh;
    for (int j = 0; j <= kNy; ++j) {
      const double y = 0.19 + 0.02 * j / kNy, root = 0.2 + std::sqrt(0.05 * 0.05 - (y - 0.2) * (y - 0.2));
      for (int i = 0; i <= kNx; ++i) mesh.vertices.push_back({root + (0.6 - root) * i / kNx, y, 0});
    }
    for (int j = 0; j < kNy; ++j) {
      for (int i = 0; i < kNx; ++i) {
        const int64_t p = j * (kNx + 1) + i;
        for (const int64_t q : {p, p + 1, p + kNx + 2, p + kNx + 1}) mesh.cells.push_back(q);
      }
    }
    d.mesh = mesh, d.element = Cell::quad9;
    d.sets = {{"root", {}, {}, Vec3{0.2501, 1, 1}}};
    d.pinned = {"root"};
    FemRun run(d, 1, {0, -2, 0});
    run.step();
    const Vec3 a = run.displacement_at({0.6, 0.2, 0});
    EXPECT_NEAR(a.x, ux, 0.005 * std::abs(ux));
    EXPECT_NEAR(a.y, uy, 0.005 * std::abs(uy));
    d.poisson_ratio = 0.3;
    FemRun control(d, 1, {0, -2, 0});
    control.step();
    EXPECT_GT(std::abs(control.displacement_at({0.6, 0.2, 0}).y - uy), 0.02 * std::abs(uy));
  }
}

// fem.torsion: a square bar whose ends rotate in their planes and warp freely; torque from the energy.
TEST(FemStatic, ASquareBarTwistsAsSaintVenantSays) {
  FemDef d = still(Law::linear, 2.6, 0.3);  // G = 1
  d.block =
      SoftBlockShape{.origin = {0, -0.5, -0.5}, .size = {2, 1, 1}, .cells_x = 2, .cells_y = 6, .cells_z = 6};
  d.element = Cell::hex27;
  d.holds = {{"x0", {}, "0", "0"}, {"x1", {}, "-0.01*Z", "0.01*Y"}, {"centre", "0", {}, {}}};
  d.sets = {{"centre", {}, Vec3{-0.01, -0.01, -0.01}, Vec3{0.01, 0.01, 0.01}}};
  FemRun run(d);
  run.step();
  // E = G J phi^2 / 2 L
  const double j = run.observe("energy.elastic") * 2 * 2 / (0.01 * 0.01);
  EXPECT_NEAR(j, 0.1405770149551537, 0.002 * 0.14);
  d.holds[0].x = d.holds[1].x = "0";  // warping held
  d.holds.pop_back();
  FemRun control(d);
  control.step();
  EXPECT_GT(control.observe("energy.elastic") * 4 / 1e-4, 0.1405 * 1.02);
}

// fem.bisshopp_drucker: the elastica under a dead load at its tip. A strip 100 times as long as high has
// little extension and shear: (h/L)^2 = 1e-4 times the order of 1.
TEST(FemStatic, ASlenderStripIsTheElastica) {
  constexpr double kH = 0.01, kE = 1.2e7;  // E I = 1 for a thickness of 1
  for (const auto& [alpha, down, across] : {std::array{1., 0.3017207737998135, 0.05643323628337688},
                                            {4., 0.6699641812776668, 0.328941242246846}}) {
    FemDef d = still(Law::st_venant_kirchhoff, kE, 0);
    d.quad = QuadShape{{{0, 0, 0}, {1, 0, 0}, {1, kH, 0}, {0, kH, 0}}, 50, 1};
    d.element = Cell::quad9, d.pinned = {"x0"}, d.load_time = 1;
    d.loads = {{"x1", Vec3{0, -alpha, 0}, {}, {}, {}, {}}};
    FemRun run(d, 0.125);
    run.step(8);
    const Vec3 tip = run.displacement_at({1, kH / 2, 0});
    EXPECT_NEAR(-tip.y, down, 1e-3 * down);
    EXPECT_NEAR(-tip.x, across, 1e-3 * across);
    d.material = Law::linear;
    FemRun control(d, 0.125);
    control.step(8);
    EXPECT_GT(-control.displacement_at({1, kH / 2, 0}).y, 1.05 * down);
  }
}

// fem.lame: thick sphere, an eighth of it, under pressure inside; u_r(a) / p = 0.8.
TEST(FemStatic, AThickSphereWidensAsLameSays) {
  constexpr int kN = 10, kR = 10;
  CellsShape mesh;
  std::vector<std::array<int64_t, 3>> known;
  const auto vertex = [&](const Vec3& v) {
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
      if (norm(mesh.vertices[i] - v) < 1e-9) return static_cast<int64_t>(i);
    }
    mesh.vertices.push_back(v);
    return static_cast<int64_t>(mesh.vertices.size() - 1);
  };
  // Three patches of the octant, each between a corner, the middles of two edges and the centre.
  const Vec3 axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (size_t p = 0; p < 3; ++p) {
    const Vec3 a = axis[p], b = normalized(a + axis[(p + 1) % 3]), m = normalized(Vec3{1, 1, 1}),
               c = normalized(a + axis[(p + 2) % 3]);
    const auto at = [&](int i, int j, int k) {
      const double u = static_cast<double>(i) / kN, v = static_cast<double>(j) / kN;
      return (1 + static_cast<double>(k) / kR) *
             normalized((1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * m));
    };
    for (int k = 0; k < kR; ++k) {
      for (int j = 0; j < kN; ++j) {
        for (int i = 0; i < kN; ++i) {
          for (const int r : {k, k + 1}) {
            for (const auto& [x, y] : {std::pair{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}}) {
              mesh.cells.push_back(vertex(at(x, y, r)));
            }
          }
        }
      }
    }
  }
  FemDef d = still(Law::linear, 1, 0.3);
  d.mesh = mesh, d.element = Cell::hex8;
  d.sets = {{"x", {}, {}, Vec3{1e-9, 9, 9}},
            {"y", {}, {}, Vec3{9, 1e-9, 9}},
            {"z", {}, {}, Vec3{9, 9, 1e-9}},
            {"inside", {}, {}, {}}};
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (norm(mesh.vertices[i]) < 1.01) d.sets[3].points.push_back(static_cast<int64_t>(i));
  }
  d.holds = {{"x", "0", {}, {}}, {"y", {}, "0", {}}, {"z", {}, {}, "0"}};
  d.loads = {{"inside", {}, {}, {}, {}, 1e-6}};
  FemRun run(d);
  run.step();
  EXPECT_NEAR(run.displacement_at({1, 0, 0}).x / 1e-6, 0.8, 0.01 * 0.8);
  d.loads[0].pressure = -1e-6;
  FemRun control(d);
  control.step();
  EXPECT_LT(control.displacement_at({1, 0, 0}).x, 0);
}

// A bar of round section, filled with tetrahedra of an unstructured lattice, is stretched: F = E A e.
TEST(FemStatic, AFilledCylinderStretchesAsABar) {
  FemDef d;
  d.fill = FillShape{
      .ball = {}, .cylinder = CylinderRegion{{0, 0, 0}, {1, 0, 0}, 0.1}, .surface = {}, .spacing = 0.04};
  d.element = Cell::tet10, d.material = Law::linear, d.youngs_modulus = 1e6, d.poisson_ratio = 0;
  d.motion = Motion::quasi_static;
  d.sets = {{"left", {}, {}, Vec3{0.01, 1, 1}}, {"right", {}, Vec3{0.99, -1, -1}, {}}};
  d.holds = {{"left", "0", "0", "0"}, {"right", "0.001", "0", "0"}};
  FemRun run(d);
  run.step();
  // Held nodes lie up to 0.01 from the ends, and the lattice's section is smaller than the circle by facets
  // of second order in 0.04 / 0.1.
  const double pi = 3.14159265358979323846, bar = 1e6 * pi * 0.01 * 0.001;
  double volume = 0;
  for (const double w : run.system->body().weights) volume += w;
  EXPECT_NEAR(volume, pi * 0.01, 0.05 * pi * 0.01);
  EXPECT_NEAR(std::abs(run.observe("energy.elastic")), 0.5 * bar * 0.001, 0.06 * 0.5 * bar * 0.001);
}

}  // namespace
}  // namespace truestep::fem
