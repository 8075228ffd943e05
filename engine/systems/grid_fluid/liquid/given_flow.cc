#include "engine/systems/grid_fluid/liquid/given_flow.h"

#include <algorithm>
#include <cmath>

namespace truestep::grid_fluid {

namespace {
double along_axis(const Vec3& v, size_t a) {
  return a == 0 ? v.x : a == 1 ? v.y : v.z;
}
}  // namespace

void GivenFlow::bind(const FlowModel& m, std::span<const LiquidInlet> inlets) {
  model_ = &m, inlets_ = inlets, sampled_ = false;
  pipes_.assign(inlets.size(), {});
  for (size_t k = 0; k < inlets.size(); ++k) find_pipe(inlets[k], pipes_[k]);
  sides_.clear();
  for (size_t a = 0; a < m.grid.dimensions; ++a) {
    for (size_t end = 0; end < 2; ++end) {
      if (m.kinds[a][end] == SideKind::inflow) sides_.push_back({a, end, {}});
    }
  }
}

void GivenFlow::find_pipe(const LiquidInlet& inlet, Pipe& pipe) const {
  const mac::MacGrid& g = model_->grid;
  constexpr double kSlack = 1e-6;  // cells: a face right at the back is within
  const double slack = kSlack * g.spacing[0];
  for (size_t c = 0; c < g.dimensions; ++c) {
    for (size_t k = 0; k < g.count(c, 2); ++k) {
      for (size_t j = 0; j < g.count(c, 1); ++j) {
        for (size_t i = 0; i < g.count(c, 0); ++i) {
          const size_t at = g.at(i, j, k);
          const Vec3 from = g.position(c, at) - inlet.mouth;
          const double way = dot(from, inlet.along);
          if (way < slack && way > -0.5 * inlet.depth - slack && norm(from - inlet.along * way) < inlet.reach)
            pipe.faces[c].push_back(static_cast<uint32_t>(at));
        }
      }
    }
  }
  // Each place's share of a layer, in the cell behind the last face that is held.
  const double area = g.dimensions == 3 ? inlet.spacing * inlet.spacing : inlet.spacing;
  for (const Vec3& place : inlet.places) {
    const Vec3 p = inlet.mouth - inlet.along * (0.5 * inlet.depth + 2 * slack) + place;
    size_t cell[3] = {};
    for (size_t a = 0; a < g.dimensions; ++a) {
      const double x = (along_axis(p, a) - g.origin[a]) / g.spacing[a];
      cell[a] = static_cast<size_t>(std::clamp(x, 0.0, static_cast<double>(g.cells[a] - 1)));
    }
    const auto at = static_cast<uint32_t>(g.at(cell[0], cell[1], cell[2]));
    const double rate = inlet.speed * area / g.cell_volume();
    const auto same = std::ranges::find(pipe.sources, at, &Source::cell);
    if (same == pipe.sources.end()) {
      pipe.sources.push_back({at, rate});
    } else {
      same->rate += rate;
    }
  }
}

void GivenFlow::place(double t, Room room) {
  time_ = t, room_ = room;
  if (sampled_ && !model_->texts.sides_move) return;
  for (Side& s : sides_) model_->texts.sample_side(model_->grid, s.axis, s.end, s.axis, t, s.normal);
  sampled_ = true;
}

// f(face, velocity) of component c.
template <class F>
void GivenFlow::for_faces(size_t c, F&& f) const {
  const mac::MacGrid& g = model_->grid;
  for (const Side& s : sides_) {
    if (s.axis != c) continue;
    const size_t first = c == 0 ? 1 : 0, second = c == 2 ? 1 : 2;
    const size_t ghosts = second < g.dimensions ? mac::kGhosts : 0;
    for (size_t q = 0; q < g.cells[second]; ++q) {
      for (size_t p = 0; p < g.cells[first]; ++p) {
        const size_t plane = p + mac::kGhosts + g.padded(first) * (q + ghosts);
        f(g.base() + g.stride(first) * p + g.stride(second) * q + g.stride(c) * (s.end == 0 ? 0 : g.cells[c]),
          s.normal[plane]);
      }
    }
  }
  for (size_t k = 0; k < pipes_.size() && room_ == Room::left; ++k) {
    if (!inlets_[k].pours(time_)) continue;
    const double u = along_axis(inlets_[k].velocity(), c);
    for (const uint32_t at : pipes_[k].faces[c]) f(at, u);
  }
}

void GivenFlow::hold(size_t c, double* u) const {
  for_faces(c, [&](size_t at, double value) { u[at] = value; });
}

void GivenFlow::mark(size_t c, uint8_t* known) const {
  for_faces(c, [&](size_t at, double) { known[at] = 1; });
}

void GivenFlow::shut(size_t c, double* factor) const {
  for_faces(c, [&](size_t at, double) { factor[at] = 0; });
}

void GivenFlow::take_sources(const uint8_t* liquid, double* divergence) const {
  for (size_t k = 0; k < pipes_.size() && room_ == Room::left; ++k) {
    if (!inlets_[k].pours(time_)) continue;
    for (const Source& s : pipes_[k].sources) divergence[s.cell] -= liquid[s.cell] ? s.rate : 0;
  }
}

const LiquidInlet* GivenFlow::holder(const Vec3& at) const {
  for (const LiquidInlet& inlet : inlets_) {
    if (room_ == Room::left && inlet.pours(time_) && inlet.contains(at)) return &inlet;
  }
  return nullptr;
}

double GivenFlow::crossing_rate() const {
  const mac::MacGrid& g = model_->grid;
  double most = 0;
  for (const Side& s : sides_) {
    for (const double u : s.normal) most = std::max(most, std::abs(u) / g.spacing[s.axis]);
  }
  for (const LiquidInlet& inlet : inlets_) {
    if (!inlet.pours(time_)) continue;
    const Vec3 u = inlet.velocity();
    most = std::max(most, (std::abs(u.x) + std::abs(u.y) + std::abs(u.z)) / g.spacing[0]);
  }
  return most;
}

}  // namespace truestep::grid_fluid
