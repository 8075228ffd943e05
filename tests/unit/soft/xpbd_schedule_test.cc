// Every constraint occurs once, and those of one colour share no point.
#include "engine/systems/xpbd/schedule.h"

#include <gtest/gtest.h>

#include <set>

namespace truestep::xpbd {
namespace {

XpbdDef cloth(int nx, int ny) {
  XpbdDef d;
  d.cloth_grid = ClothGridShape{.nx = nx, .ny = ny};
  d.flexural_rigidity = 1;
  return d;
}

/// Checks the chains of a schedule; returns the number of links that they hold.
size_t check_chains(const Body& body, const Schedule& s) {
  std::vector<int> seen(body.links.size());
  const auto lanes = static_cast<size_t>(s.lanes);
  for (const Colour& colour : s.chains.colours) {
    std::set<uint32_t> points;
    for (size_t b = colour.begin; b < colour.end; ++b) {
      const ChainBatch& batch = s.chains.batches[b];
      EXPECT_LE(batch.links, colour.longest);
      for (size_t lane = 0; lane < lanes; ++lane) {
        for (size_t k = 0; k <= batch.links; ++k) {
          const uint32_t p = s.chains.points[batch.first_point + k * lanes + lane];
          if (p < body.x.size()) {
            EXPECT_TRUE(points.insert(p).second) << "point " << p << " twice in a colour";
          } else {
            EXPECT_LT(p, s.rows);
          }
          if (k == batch.links) continue;
          const uint32_t link = s.chains.link[batch.first_link + k * lanes + lane];
          if (link == kNobody) continue;
          ++seen[link];
          const uint32_t q = s.chains.points[batch.first_point + (k + 1) * lanes + lane];
          const Link& l = body.links[link];
          EXPECT_TRUE((l.a == p && l.b == q) || (l.a == q && l.b == p));
        }
      }
    }
  }
  size_t count = 0;
  for (const int n : seen) {
    EXPECT_EQ(n, 1);
    count += static_cast<size_t>(n);
  }
  return count;
}

template <size_t N, class Members>
void check_set(const Members& members, const SetSchedule& s, size_t lanes, size_t points) {
  std::vector<int> seen(members.size());
  for (const Colour& colour : s.colours) {
    std::set<uint32_t> taken;
    for (size_t e = colour.begin * lanes; e < colour.end * lanes; ++e) {
      const uint32_t member = s.member[e];
      for (size_t i = 0; i < N; ++i) {
        const uint32_t p = s.points[(e / lanes * N + i) * lanes + e % lanes];
        if (member == kNobody) {
          EXPECT_GE(p, points);
        } else {
          EXPECT_EQ(p, members[member].points[i]);
          EXPECT_TRUE(taken.insert(p).second);
        }
      }
      if (member != kNobody) ++seen[member];
    }
  }
  for (const int n : seen) EXPECT_EQ(n, 1);
}

TEST(XpbdSchedule, ChainsOfAGridAreItsLines) {
  const Body body = build_body(cloth(13, 9), {0, -1, 0});
  for (const int lanes : {4, 8}) {
    const Schedule s(body, Sweep::chains, lanes);
    EXPECT_EQ(check_chains(body, s), body.links.size());
    // Diagonals two ways, columns, rows.
    ASSERT_EQ(s.chains.colours.size(), 4u);
    EXPECT_EQ(s.chains.colours[3].longest, 12u);
    EXPECT_EQ(s.chains.colours[2].longest, 8u);
    check_set<3>(body.rods, s.rods, static_cast<size_t>(lanes), body.x.size());
  }
}

TEST(XpbdSchedule, LinksByThemselves) {
  const Body body = build_body(cloth(7, 5), {0, -1, 0});
  const Schedule s(body, Sweep::links, 8);
  EXPECT_EQ(check_chains(body, s), body.links.size());
  for (const Colour& c : s.chains.colours) EXPECT_EQ(c.longest, 1u);
}

TEST(XpbdSchedule, MeshesHairAndBlocks) {
  XpbdDef mesh;
  // A fan about point 0: its links cannot have one colour.
  MeshShape fan{.vertices = {{0, 0, 0}}};
  for (int k = 0; k < 7; ++k) {
    fan.vertices.push_back({k < 4 ? 1.0 : -1.0, 0.3 * k, 0.1 * k * k});
    if (k > 0) fan.triangles.insert(fan.triangles.end(), {0, k, k + 1});
  }
  mesh.mesh = fan, mesh.flexural_rigidity = 1;
  const Body bent = build_body(mesh, {0, -1, 0});
  EXPECT_TRUE(bent.hinges.empty());
  EXPECT_EQ(bent.angles.size(), 5u);
  const Schedule s(bent, Sweep::chains, 4);
  EXPECT_EQ(check_chains(bent, s), bent.links.size());
  check_set<4>(bent.angles, s.angles, 1, bent.x.size());

  XpbdDef hair;
  hair.hair = HairShape{.strands = 11, .links = 5};
  hair.bending_rigidity = 1;
  const Body strands = build_body(hair, {0, -1, 0});
  const Schedule h(strands, Sweep::chains, 8);
  EXPECT_EQ(check_chains(strands, h), 55u);
  EXPECT_EQ(h.chains.colours.size(), 1u);

  XpbdDef block;
  block.block = SoftBlockShape{.cells_x = 2, .cells_y = 3, .cells_z = 2};
  const Body soft = build_body(block, {0, -1, 0});
  const Schedule b(soft, Sweep::chains, 4);
  EXPECT_EQ(check_chains(soft, b), soft.links.size());
  check_set<4>(soft.tetrahedra, b.volumes, 4, soft.x.size());
}

}  // namespace
}  // namespace truestep::xpbd
