// Ewald's smooth part through a mesh against the sum over waves.
#include "engine/kernels/molecular/mesh_ewald.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.h"

namespace truestep::molecular {
namespace {

struct Salt {
  Vec3 edges{7, 8, 9.5};
  std::vector<double> x, q;
};

/// Charges of both signs at random in a box (and in its neighbours), their sum 0.
Salt salt(size_t n) {
  Salt out;
  for (size_t i = 0; i < n; ++i) {
    const auto u = uniform4(3, 0, i);
    for (const double c : {(2 * u[0] - 0.5) * 7, (2 * u[1] - 0.5) * 8, (2 * u[2] - 0.5) * 9.5})
      out.x.push_back(c);
    out.q.push_back(i % 2 ? 1 : -1);
  }
  return out;
}

struct Answer {
  EwaldEnergy energy;
  std::vector<double> force;
};

Answer by_waves(const Salt& s, const EwaldSetting& setting) {
  Answer out;
  out.force.resize(s.x.size());
  EwaldSum sum;
  // Far beyond the cut-off of the mesh's own waves.
  EwaldSetting all = setting;
  all.k_max *= 1.6;
  out.energy = sum.add(all, s.edges, s.x, s.q, out.force, ThreadArena(1));
  return out;
}

Answer by_mesh(const Salt& s, const MeshSetting& setting, int threads = 1) {
  Answer out;
  out.force.resize(s.x.size());
  MeshEwald sum;
  out.energy = sum.add(setting, s.edges, s.x, s.q, out.force, ThreadArena(threads));
  return out;
}

/// Root mean square of the difference of forces over that of two neighbours at the cut-off, 1/cutoff^2.
double error(const Answer& a, const Answer& b, double cutoff) {
  double sum = 0;
  for (size_t k = 0; k < a.force.size(); ++k) sum += (a.force[k] - b.force[k]) * (a.force[k] - b.force[k]);
  return std::sqrt(3 * sum / static_cast<double>(a.force.size())) * cutoff * cutoff;
}

TEST(MeshEwald, ForcesAreThoseOfTheWavesToTheAccuracyAskedFor) {
  const Salt s = salt(400);
  constexpr double kCutoff = 2.5;
  for (const double accuracy : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7}) {
    const EwaldSetting setting = ewald_setting(1, kCutoff, accuracy);
    const MeshSetting mesh = mesh_setting(setting, s.edges, accuracy);
    const Answer waves = by_waves(s, setting), meshed = by_mesh(s, mesh);
    // 400 charges at random add up: sqrt of the some thirty within reach times the error of one pair.
    EXPECT_LT(error(waves, meshed, kCutoff), 6 * accuracy) << accuracy << " order " << mesh.order;
    EXPECT_NEAR(meshed.energy.energy / waves.energy.energy, 1, 6 * accuracy) << accuracy;
    EXPECT_NEAR(meshed.energy.virial / waves.energy.energy, waves.energy.virial / waves.energy.energy,
                20 * accuracy);
    Vec3 net;
    for (size_t i = 0; i < s.q.size(); ++i) net += load3(meshed.force.data(), i);
    EXPECT_LT(norm(net), 1e-11);
    // Control: two thirds of the points are not enough.
    MeshSetting coarse = mesh;
    for (size_t& k : coarse.points) k = k * 2 / 3;
    EXPECT_GT(error(waves, by_mesh(s, coarse), kCutoff), 3 * error(waves, meshed, kCutoff));
  }
}

TEST(MeshEwald, ForcesAreTheGradientOfTheEnergy) {
  Salt s = salt(40);
  const MeshSetting mesh{.ewald = ewald_setting(1, 2.5, 1e-3), .order = 4, .points = {10, 12, 15}};
  const auto energy = [&] { return by_mesh(s, mesh).energy.energy; };
  const Answer at = by_mesh(s, mesh);
  // The net force is removed from all atoms: differences of two atoms' forces are those of the gradient.
  const auto slope = [&](size_t k) {
    constexpr double kStep = 1e-4;
    const double x = s.x[k];
    s.x[k] = x + kStep;
    const double up = energy();
    s.x[k] = x - kStep;
    const double down = energy();
    s.x[k] = x;
    return (up - down) / (2 * kStep);
  };
  for (size_t c = 0; c < 3; ++c) {
    // Differences err by (step k)^2/6 of a slope, k some 5: 4e-8.
    EXPECT_NEAR(at.force[c] - at.force[3 + c], slope(3 + c) - slope(c), 1e-6) << c;
  }
}

TEST(MeshEwald, AnyNumberOfThreadsGivesTheSameBits) {
  const Salt s = salt(700);
  const MeshSetting mesh = mesh_setting(ewald_setting(1, 2.5, 1e-4), s.edges, 1e-4);
  const Answer one = by_mesh(s, mesh), four = by_mesh(s, mesh, 4);
  EXPECT_EQ(one.force, four.force);
  EXPECT_EQ(one.energy.energy, four.energy.energy);
  EXPECT_NE(one.force, by_mesh(s, mesh_setting(mesh.ewald, s.edges, 1e-3)).force);
}

}  // namespace
}  // namespace truestep::molecular
