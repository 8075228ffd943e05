#include "engine/systems/xpbd/schedule.h"

#include <algorithm>

namespace truestep::xpbd {

namespace {

/// Points from first to last, and the links between them.
struct Path {
  std::vector<uint32_t> points, links;
};

/// Cuts the links of a body into paths; paths of one colour share no point.
class PathFinder {
 public:
  explicit PathFinder(const Body& body) : body_(body), begin_(body.x.size() + 1), used_(body.links.size()) {
    for (const Link& l : body.links) ++begin_[l.a + 1], ++begin_[l.b + 1];
    for (size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    at_.resize(begin_.back());
    auto next = begin_;
    for (uint32_t k = 0; k < body.links.size(); ++k) {
      at_[next[body.links[k].a]++] = k, at_[next[body.links[k].b]++] = k;
    }
  }

  std::vector<std::vector<Path>> find() {
    std::vector<std::vector<Path>> colours;
    std::vector<uint32_t> taken(body_.x.size(), 0);  // last colour that has the point, from 1
    std::vector<uint32_t> open(body_.links.size());
    for (uint32_t k = 0; k < open.size(); ++k) open[k] = k;
    while (!open.empty()) {
      auto& paths = colours.emplace_back();
      const auto colour = static_cast<uint32_t>(colours.size());
      for (const uint32_t k : open) {
        const Link& l = body_.links[k];
        if (used_[k] || taken[l.a] == colour || taken[l.b] == colour) continue;
        paths.push_back(grow(k, colour, taken));
      }
      std::erase_if(open, [&](uint32_t k) { return used_[k] != 0; });
    }
    return colours;
  }

 private:
  Path grow(uint32_t k, uint32_t colour, std::vector<uint32_t>& taken) {
    const Link& first = body_.links[k];
    Path path{{first.a, first.b}, {k}};
    used_[k] = 1, taken[first.a] = taken[first.b] = colour;
    const auto extend = [&] {
      while (true) {
        const uint32_t end = path.points.back(), before = path.points[path.points.size() - 2];
        const uint32_t next = straightest(before, end, body_.links[path.links.back()].family, colour, taken);
        if (next == kNobody) return;
        const Link& l = body_.links[next];
        used_[next] = 1;
        path.points.push_back(l.a == end ? l.b : l.a), path.links.push_back(next);
        taken[path.points.back()] = colour;
      }
    };
    extend();
    std::reverse(path.points.begin(), path.points.end()), std::reverse(path.links.begin(), path.links.end());
    extend();
    std::reverse(path.points.begin(), path.points.end()), std::reverse(path.links.begin(), path.links.end());
    return path;
  }

  /// The unused link of the family at `end` that turns the path least, by less than 60 degrees, and leads to
  /// a point without this colour.
  uint32_t straightest(uint32_t before, uint32_t end, Family family, uint32_t colour,
                       const std::vector<uint32_t>& taken) const {
    const Vec3 d = normalized(body_.x[end] - body_.x[before]);
    uint32_t best = kNobody;
    double most = 0.5;
    for (size_t e = begin_[end]; e < begin_[end + 1]; ++e) {
      const uint32_t k = at_[e];
      const Link& l = body_.links[k];
      const uint32_t other = l.a == end ? l.b : l.a;
      if (used_[k] || l.family != family || taken[other] == colour) continue;
      const double along = dot(d, normalized(body_.x[other] - body_.x[end]));
      if (along > most) most = along, best = k;
    }
    return best;
  }

  const Body& body_;
  std::vector<size_t> begin_;
  std::vector<uint32_t> at_;
  std::vector<uint8_t> used_;
};

/// Greedy colouring: each member gets the smallest colour that no earlier member with a common point has.
template <class Points>
std::vector<std::vector<uint32_t>> colour_greedily(size_t points, size_t members, const Points& points_of) {
  std::vector<std::vector<uint32_t>> at(points);  // colours of a point
  std::vector<std::vector<uint32_t>> colours;
  for (uint32_t k = 0; k < members; ++k) {
    uint32_t colour = 0;
    const auto has = [&](uint32_t p) { return std::find(at[p].begin(), at[p].end(), colour) != at[p].end(); };
    const auto& mine = points_of(k);
    while (std::any_of(mine.begin(), mine.end(), has)) ++colour;
    for (const uint32_t p : mine) at[p].push_back(colour);
    if (colour == colours.size()) colours.emplace_back();
    colours[colour].push_back(k);
  }
  return colours;
}

ChainSchedule schedule_paths(std::vector<std::vector<Path>> colours, size_t lanes, size_t& rows) {
  // Springs added later (diagonals) first: the stiffest are solved last.
  std::reverse(colours.begin(), colours.end());
  ChainSchedule out;
  for (auto& paths : colours) {
    std::stable_sort(paths.begin(), paths.end(),
                     [](const Path& a, const Path& b) { return a.links.size() > b.links.size(); });
    Colour colour{out.batches.size(), 0, static_cast<uint32_t>(paths.front().links.size())};
    for (size_t first = 0; first < paths.size(); first += lanes) {
      const size_t links = paths[first].links.size();
      bool padded = false;
      const auto dummy = static_cast<uint32_t>(rows);
      out.batches.push_back({static_cast<uint32_t>(links), out.link.size(), out.points.size()});
      for (size_t s = 0; s <= links; ++s) {
        for (size_t lane = 0; lane < lanes; ++lane) {
          const Path* path = first + lane < paths.size() ? &paths[first + lane] : nullptr;
          const bool point = path && s < path->points.size(), link = path && s < path->links.size();
          padded |= !point;
          out.points.push_back(point ? path->points[s] : dummy);
          if (s < links) out.link.push_back(link ? path->links[s] : kNobody);
        }
      }
      rows += padded;
    }
    colour.end = out.batches.size();
    out.colours.push_back(colour);
  }
  return out;
}

template <size_t N, class Points>
SetSchedule schedule_set(size_t points, size_t members, size_t lanes, size_t& rows, const Points& points_of) {
  SetSchedule out;
  for (const auto& colour : colour_greedily(points, members, points_of)) {
    const size_t begin = out.member.size() / lanes;
    for (size_t first = 0; first < colour.size(); first += lanes) {
      const auto dummy = static_cast<uint32_t>(rows);
      const bool padded = first + lanes > colour.size();
      for (size_t i = 0; i < N; ++i) {
        for (size_t lane = 0; lane < lanes; ++lane) {
          const bool there = first + lane < colour.size();
          out.points.push_back(there ? points_of(colour[first + lane])[i] : dummy);
        }
      }
      for (size_t lane = 0; lane < lanes; ++lane) {
        out.member.push_back(first + lane < colour.size() ? colour[first + lane] : kNobody);
      }
      rows += padded;
    }
    out.colours.push_back({begin, out.member.size() / lanes});
  }
  return out;
}

std::vector<std::vector<Path>> single_links(const Body& body) {
  std::vector<std::vector<Path>> out;
  const auto ends = [&](uint32_t k) { return std::array<uint32_t, 2>{body.links[k].a, body.links[k].b}; };
  for (const auto& colour : colour_greedily(body.x.size(), body.links.size(), ends)) {
    auto& paths = out.emplace_back();
    for (const uint32_t k : colour) paths.push_back({{body.links[k].a, body.links[k].b}, {k}});
  }
  return out;
}

}  // namespace

Schedule::Schedule(const Body& body, Sweep sweep, int lanes, const TearSurface* tears)
    : lanes(lanes), rows(body.capacity) {
  const size_t n = body.x.size(), wide = static_cast<size_t>(lanes);
  chains = schedule_paths(sweep == Sweep::chains ? PathFinder(body).find() : single_links(body), wide, rows);
  rods = schedule_set<3>(n, body.rods.size(), wide, rows, [&](uint32_t k) { return body.rods[k].points; });
  hinges =
      schedule_set<4>(n, body.hinges.size(), wide, rows, [&](uint32_t k) { return body.hinges[k].points; });
  angles = schedule_set<4>(n, body.angles.size(), 1, rows, [&](uint32_t k) { return body.angles[k].points; });
  volumes = schedule_set<4>(n, body.tetrahedra.size(), wide, rows,
                            [&](uint32_t k) { return body.tetrahedra[k].points; });
  sheet = schedule_set<3>(n, body.sheet.size(), wide, rows, [&](uint32_t k) { return body.sheet[k].points; });
  if (!tears) return;
  for (uint32_t k = 0; k < body.links.size(); ++k) {
    for (uint32_t i = 0; i < tears->sides(k); ++i) strand_of.push_back({k, i});
  }
  const auto ends = [&](uint32_t s) {
    const Link& l = body.links[strand_of[s][0]];
    return std::array<uint32_t, 2>{l.a, l.b};
  };
  std::vector<std::vector<Path>> paths;
  for (const auto& colour : colour_greedily(n, strand_of.size(), ends)) {
    auto& to = paths.emplace_back();
    for (const uint32_t s : colour) to.push_back({{ends(s)[0], ends(s)[1]}, {s}});
  }
  strands = schedule_paths(std::move(paths), wide, rows);
  spare_rows = rows, rows += strands.batches.size();
}

}  // namespace truestep::xpbd
