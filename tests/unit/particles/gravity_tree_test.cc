// The tree of bodies: its contents, and its sums against all pairs.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/kernels/gravity/fast_multipole.h"
#include "engine/kernels/gravity/local_field.h"
#include "engine/kernels/gravity/mixed_sums.h"
#include "tests/support/runs/nbody_run.h"

namespace truestep::gravity {
namespace {

using testing_rig::spiral_plummer;

struct Cloud {
  std::vector<double> x, mu;
  Bodies bodies() const { return {x, mu}; }
};

Cloud plummer(size_t n) {
  Cloud c;
  for (const Vec3& p : spiral_plummer(n).positions) c.x.insert(c.x.end(), {p.x, p.y, p.z});
  c.mu.assign(n, 1 / static_cast<double>(n));
  return c;
}

struct Errors {
  double mean = 0, rms = 0, potential = 0, met = 0;
};

enum class Way : uint8_t { walks, multipoles };

/// Errors of the tree's sums relative to those over all pairs.
Errors errors(const Cloud& cloud, const TreeSettings& settings, Way way = Way::walks) {
  const ThreadArena one(1);
  const size_t n = cloud.mu.size();
  BodyTree tree;
  tree.build(cloud.bodies(), one);
  std::vector<double> a(3 * n), p(n), exact(3 * n);
  std::vector<TreeWork> work(tree.groups().size());
  MultipoleScratch multipoles;
  if (way == Way::walks) tree_sums(tree, settings, {a, p, work}, one);
  if (way == Way::multipoles) multipole_sums(tree, settings, {a, p, work}, multipoles, one);
  DirectScratch scratch;
  direct_accelerations(cloud.bodies(), settings.softening, exact, scratch, one);
  Errors e;
  double energy = 0;
  for (size_t i = 0; i < n; ++i) {
    const Vec3 d = load3(a.data(), i) - load3(exact.data(), i);
    const double relative = norm(d) / norm(load3(exact.data(), i));
    e.mean += relative / static_cast<double>(n), e.rms += relative * relative / static_cast<double>(n);
    energy += 0.5 * cloud.mu[i] * p[i];
  }
  e.rms = std::sqrt(e.rms);
  e.potential = std::abs(energy / direct_potential(cloud.bodies(), settings.softening, scratch, one) - 1);
  for (size_t k = 0; k < work.size(); ++k) {
    const auto share =
        static_cast<double>(tree.groups()[k].end - tree.groups()[k].begin) / static_cast<double>(n);
    e.met += share * (work[k].bodies + work[k].nodes + work[k].far_nodes);
  }
  return e;
}

TEST(MixedSums, AllPairsToTheRoundingOfFloats) {
  const ThreadArena one(1), four(4);
  for (const double eps : {0.0, 0.01}) {
    for (const size_t n : {3, 70, 4096}) {
      const Cloud cloud = plummer(n);
      BodyTree tree;
      tree.build(cloud.bodies(), one);
      std::vector<double> a(3 * n), exact(3 * n), again(3 * n);
      DirectScratch scratch;
      const Softening softening{SofteningKind::plummer, eps};
      MixedScratch mixed;
      mixed_accelerations(tree, softening, a, mixed, one);
      mixed_accelerations(tree, softening, again, mixed, four);
      EXPECT_EQ(a, again) << "the same bits on any number of threads";
      direct_accelerations(cloud.bodies(), softening, exact, scratch, one);
      double square = 0, worst = 0;
      for (size_t i = 0; i < n; ++i) {
        const double e = norm(load3(a.data(), i) - load3(exact.data(), i)) / norm(load3(exact.data(), i));
        square += e * e / static_cast<double>(n), worst = std::max(worst, e);
      }
      // A pair is accurate to some 1e-7; in the middle ten times as much cancels.
      EXPECT_LT(std::sqrt(square), 3e-7) << n;
      EXPECT_LT(worst, 1e-5) << n;
      // Control: floats are in use.
      if (n == 4096) {
        EXPECT_GT(std::sqrt(square), 1e-9);
      }
    }
  }
}

TEST(GravityTree, HoldsEveryBodyOnceAndItsMoments) {
  Cloud cloud = plummer(3000);
  // Many at one position, more than a group holds, and some without mass.
  for (size_t i = 0; i < 150; ++i) {
    for (size_t k = 0; k < 3; ++k) cloud.x[3 * (7 * i) + k] = 0.25;
    cloud.mu[13 * i] = 0;
  }
  const ThreadArena one(1);
  BodyTree tree;
  tree.build(cloud.bodies(), one);
  std::vector<int> in_leaf(3000), in_group(3000);
  for (const auto& n : tree.nodes()) {
    if (n.children == 0) {
      for (size_t k = n.begin; k < n.end; ++k) ++in_leaf[tree.row(k)];
      continue;
    }
    EXPECT_EQ(tree.nodes()[n.first_child].begin, n.begin);
    EXPECT_EQ(tree.nodes()[n.first_child + n.children - 1].end, n.end);
  }
  for (const auto& g : tree.groups()) {
    EXPECT_LE(g.end - g.begin, BodyTree::kMostInGroup);
    for (size_t k = g.begin; k < g.end; ++k) ++in_group[tree.row(k)];
  }
  EXPECT_EQ(std::count(in_leaf.begin(), in_leaf.end(), 1), 3000);
  EXPECT_EQ(std::count(in_group.begin(), in_group.end(), 1), 3000);

  // The root: mass, centre of mass and 3 S of all, in the tree's units; floats hold the moments to 1e-6.
  double mass = 0, xx = 0;
  Vec3 c;
  for (size_t k = 0; k < 3000; ++k) {
    const auto& p = tree.point(k);
    mass += p.m, c += Vec3{p.x, p.y, p.z} * p.m;
  }
  c = c / mass;
  for (size_t k = 0; k < 3000; ++k)
    xx += 3 * tree.point(k).m * (tree.point(k).x - c.x) * (tree.point(k).x - c.x);
  // Sums of 3000 terms in two orders: 3000 roundings at most.
  EXPECT_NEAR(tree.center(0).m, mass, 3e-13);
  EXPECT_NEAR(tree.center(0).x, c.x, 3e-13);
  EXPECT_NEAR(static_cast<double>(tree.moments(0).s[0]) / xx, 1, 1e-6);
  EXPECT_LE(mass, 1);
  for (size_t node = 0; node < tree.nodes().size(); ++node) {
    const auto& p = tree.center(node);
    for (size_t k = tree.nodes()[node].begin; k < tree.nodes()[node].end; ++k) {
      const Vec3 d = Vec3{tree.point(k).x, tree.point(k).y, tree.point(k).z} - Vec3{p.x, p.y, p.z};
      ASSERT_LE(norm(d), static_cast<double>(tree.columns().radius[node]));
    }
  }
}

TEST(GravityTree, ErrorsFallWithTheOpening) {
  const Cloud cloud = plummer(4096);
  // With every node opened it is the sum over all pairs: in floats to their rounding, without softening in
  // doubles.
  EXPECT_LT(errors(cloud, {{SofteningKind::plummer, 0.01}, 0}).rms, 1e-6);
  EXPECT_LT(errors(cloud, {{SofteningKind::plummer, 0}, 0}).rms, 1e-14);
  EXPECT_LT(errors(cloud, {{SofteningKind::spline, 0.05}, 0}).rms, 1e-6);
  // The case nbody.plfib_4096: a tree with quadrupoles leaves 6.8e-4 on average with 803 sources a
  // body, 4.3e-3 with 340.
  const Errors fine = errors(cloud, {{SofteningKind::plummer, 0.0}, 3e-3}),
               coarse = errors(cloud, {{SofteningKind::plummer, 0.0}, 0.1});
  EXPECT_LT(fine.mean, 6.8e-4);
  EXPECT_LT(coarse.mean, 4.3e-3);
  EXPECT_LT(coarse.met, 803);
  // Control: the errors are there, and grow.
  EXPECT_GT(fine.mean, 1e-5);
  EXPECT_GT(coarse.mean, 2 * fine.mean);
  // Potentials err less than forces: one order more of distance.
  EXPECT_LT(coarse.potential, 1e-3);
}

TEST(GravityTree, EverySofteningAndBothSums) {
  const Cloud cloud = plummer(2000);
  for (const Softening s : {Softening{SofteningKind::plummer, 0.05},
                            {SofteningKind::spline, 0.05},
                            {SofteningKind::spline, 0.0}}) {
    const Errors e = errors(cloud, {s, 1e-3});
    EXPECT_LT(e.rms, 1.5e-3) << s.length;
    EXPECT_LT(e.potential, 2e-4) << s.length;
  }
}

TEST(GravityTree, TheFastMultipoleMethodErrsAsTheTreeDoesWithLess) {
  const Cloud cloud = plummer(20000);
  for (const Softening s : {Softening{SofteningKind::plummer, 0.02},
                            {SofteningKind::plummer, 0.0},
                            {SofteningKind::spline, 0.02}}) {
    const Errors walks = errors(cloud, {s, 3e-3}), shared = errors(cloud, {s, 3e-3}, Way::multipoles);
    // A node shared by groups must satisfy the most demanding of them, from farther away: the errors are of
    // the same size.
    EXPECT_LT(shared.rms, 1.3 * walks.rms) << s.length;
    EXPECT_LT(shared.rms, 1.5e-3) << s.length;
    EXPECT_LT(shared.potential, 2e-4) << s.length;
    EXPECT_LT(shared.met, 0.9 * walks.met) << "nodes that groups meet themselves";
  }
  // With every node opened it is the sum over all pairs; control: otherwise it is not.
  EXPECT_LT(errors(plummer(3000), {{SofteningKind::plummer, 0.01}, 0}, Way::multipoles).rms, 1e-6);
  EXPECT_GT(errors(plummer(3000), {{SofteningKind::plummer, 0.01}, 0.1}, Way::multipoles).rms, 1e-4);
}

TEST(GravityTree, SeriesMoveWithoutLosingAnything) {
  LocalField field;
  field.clear();
  for (int k = 0; k < 5; ++k) {
    const auto f = static_cast<float>(k);
    field.add({2 + f, 1 - f, 3, 0.5f, {0.1f, 0.02f, 0.01f, 0.2f, 0.03f, 0.15f, 0.225f, 0}}, 0.01f);
  }
  const FieldSeries here = field.series(0.01f), there = here.shifted(0.3f, -0.2f, 0.1f);
  GroupSums<float, 64> a, b;
  a.clear(8), b.clear(8);
  for (size_t i = 0; i < 16; ++i) {
    const float u = 0.05f * static_cast<float>(i);
    a.x[i] = u, a.y[i] = -u, a.z[i] = 0.5f * u;
    b.x[i] = u - 0.3f, b.y[i] = -u + 0.2f, b.z[i] = 0.5f * u - 0.1f;
  }
  here.add_to(a), there.add_to(b);
  for (size_t i = 0; i < 8; ++i) {
    // A polynomial of third order about another place is the same polynomial: rounding of some twenty terms
    // of size 1.
    EXPECT_NEAR(a.p[i], b.p[i], 2e-6f);
    EXPECT_NEAR(a.ax[i], b.ax[i], 2e-6f);
    EXPECT_NEAR(a.ay[i], b.ay[i], 2e-6f);
    EXPECT_NEAR(a.az[i], b.az[i], 2e-6f);
  }
  EXPECT_GT(std::abs(a.ax[7] - a.ax[0]), 1e-3f) << "control: it is no constant";
}

TEST(GravityTree, ThePotentialOfAHeavyBodyIsNotItsOwn) {
  // Saturn and its ring: a body's own m/eps is 1e4 times the effect of all others, and used to be subtracted
  // with a float's rounding.
  Cloud cloud = plummer(2000);
  cloud.mu[0] = 1e6;
  EXPECT_LT(errors(cloud, {{SofteningKind::plummer, 0.01}, 1e-3}).potential, 1e-4);
  EXPECT_LT(errors(cloud, {{SofteningKind::plummer, 0.01}, 1e-3}, Way::multipoles).potential, 1e-4);
}

TEST(GravityTree, BodiesAtOnePlaceDoNotAttractEachOther) {
  Cloud cloud{std::vector<double>(3 * 500, 0.5), std::vector<double>(500, 1.0)};
  for (const double eps : {0.0, 0.1}) {
    const ThreadArena one(1);
    BodyTree tree;
    tree.build(cloud.bodies(), one);
    std::vector<double> a(1500, 1.0), exact(1500, 1.0);
    DirectScratch scratch;
    MultipoleScratch multipoles;
    multipole_sums(tree, {{SofteningKind::plummer, eps}, 1e-3}, {exact}, multipoles, one);
    for (const double v : exact) EXPECT_EQ(v, 0);
    tree_sums(tree, {{SofteningKind::plummer, eps}, 1e-3}, {a}, one);
    direct_accelerations(cloud.bodies(), {SofteningKind::plummer, eps}, exact, scratch, one);
    for (size_t k = 0; k < 1500; ++k) {
      EXPECT_EQ(a[k], 0);
      EXPECT_EQ(exact[k], 0);
    }
  }
  // Control: one of them elsewhere is attracted by all others.
  cloud.x[0] = 1.5;
  const ThreadArena one(1);
  BodyTree tree;
  tree.build(cloud.bodies(), one);
  std::vector<double> a(1500);
  tree_sums(tree, {{}, 1e-3}, {a}, one);
  EXPECT_NEAR(a[0], -499, 1e-3) << "a far node is summed in floats: 1e-6";
}

}  // namespace
}  // namespace truestep::gravity
