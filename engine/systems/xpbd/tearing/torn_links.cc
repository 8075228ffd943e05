#include "engine/systems/xpbd/tearing/torn_links.h"

#include <algorithm>

namespace truestep::xpbd {

template <class T>
void TornLinks<T>::pack(const TearSurface& tears, const Body& body, const Schedule& schedule, const State& s,
                        const Stiffness& stiffness) {
  const ChainSchedule& strands = schedule.strands;
  const size_t entries = strands.link.size(), batches = strands.batches.size();
  const auto corners = s.span<uint32_t>(tears.columns.corner);
  damped_ = stiffness.soft && stiffness.damping > 0;
  rest_.assign(entries, T(0)), compliance_.assign(entries, static_cast<T>(kIdle));
  damping_.assign(damped_ ? entries : 0, T(0)), lambda_.assign(stiffness.keeps ? entries : 0, T(0));
  base_.assign(3 * entries, T(0)), used_.assign(entries, 0), points_.resize(2 * entries);
  active_.reserve(batches), active_.clear(), q_.resize(batches);
  colours_.reserve(strands.colours.size()), colours_.clear();
  for (const Colour& colour : strands.colours) {
    const size_t begin = active_.size();
    for (size_t b = colour.begin; b < colour.end; ++b) {
      bool any = false;
      for (size_t e = b * kLanes; e < (b + 1) * kLanes; ++e) {
        uint32_t* points = points_.data() + 2 * b * kLanes + e % kLanes;
        points[0] = points[kLanes] = static_cast<uint32_t>(schedule.spare_rows + b);
        if (strands.link[e] == kNobody) continue;
        const auto [link, side] = schedule.strand_of[strands.link[e]];
        if (tears.whole(corners, link)) continue;
        const Strand strand = tears.strand(corners, link, side);
        if (!(strand.share > 0)) continue;
        const Link& l = body.links[link];
        const double k = stiffness_of(stiffness.families, l.family) * l.factor;
        points[0] = strand.a, points[kLanes] = strand.b, used_[e] = 1, any = true;
        rest_[e] = static_cast<T>(l.rest);
        compliance_[e] = static_cast<T>(!stiffness.soft ? 0 : k > 0 ? 1 / (k * strand.share) : kIdle);
        if (damped_ && k > 0) damping_[e] = static_cast<T>(stiffness.damping / k);
      }
      if (any) active_.push_back(static_cast<uint32_t>(b));
    }
    if (active_.size() > begin) colours_.push_back({begin, active_.size()});
  }
}

template <class T>
void TornLinks<T>::load(const double* x) {
  for (const uint32_t b : active_) {
    for (size_t lane = 0; lane < kLanes; ++lane) {
      if (!used_[b * kLanes + lane]) continue;
      const uint32_t* p = points_.data() + 2 * b * kLanes + lane;
      const Vec3 d = load3(x, p[kLanes]) - load3(x, p[0]);
      T* to = base_.data() + 3 * b * kLanes + lane;
      to[0] = static_cast<T>(d.x), to[kLanes] = static_cast<T>(d.y), to[2 * kLanes] = static_cast<T>(d.z);
    }
  }
}

template <class T>
T TornLinks<T>::solve(const PerStep<T>& per, const T* before, T relax, T* rows, const ThreadArena& arena) {
  for (const Colour& colour : colours_) {
    arena.for_blocks(colour.end - colour.begin, 512, [&](size_t begin, size_t end) {
      for (size_t i = colour.begin + begin; i < colour.begin + end; ++i) {
        const size_t at = active_[i] * kLanes;
        const Chains<T> c{1,
                          points_.data() + 2 * at,
                          rest_.data() + at,
                          compliance_.data() + at,
                          damped_ ? damping_.data() + at : nullptr,
                          lambda_.empty() ? nullptr : lambda_.data() + at,
                          base_.data() + 3 * at};
        ChainRow<T> scratch[1];
        q_[i] = solve_chains(c, per, before, relax, rows, scratch);
      }
    });
  }
  return active_.empty() ? T(0)
                         : *std::max_element(q_.begin(), q_.begin() + static_cast<ptrdiff_t>(active_.size()));
}

template class TornLinks<float>;
template class TornLinks<double>;

}  // namespace truestep::xpbd
