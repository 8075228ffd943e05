// Initial impulses of a scene. Small steps carry loads on from the previous one; the first has none, and a
// sweep passes a load on by only a row or two: a tall pile would sink before its lowest contacts felt its
// top. Where no contact continues another, loads are passed down once, from the highest body to the lowest:
// the load and weight of a body are shared by the contacts below it as  N_c = load cos_c / sum cos^2  (cos
// between normal and vertical), by the two points of a single contact as by a lever, and the offsets of their
// points start at the corresponding yield. Exact for stacks, close for piles of boxes; the sweeps correct the
// rest. Islands with a body whose load lies outside its support start at zero: they topple, and loaded
// springs would throw them up. Horizontal thrust (arches) is ignored.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/rigid/islands.h"
#include "engine/systems/rigid2d/solver_contact.h"

namespace truestep::rigid2d {
namespace {

/// Contacts steeper than this (cosine between normal and vertical) carry nothing at the start.
constexpr double kCarries = 0.3;
/// Offsets of two equally loaded points are merged where they differ by no more than this fraction.
constexpr double kAlike = 1.0 / 8;

}  // namespace

template <class T>
void Solver<T>::list_bearings(const Pairs& pairs, double h) {
  bearings_.clear();
  const Vec2 pull{push_[0], push_[1]};
  const double speed = flat::norm(pull);
  if (!(speed > 0)) return;
  const Vec2 up = (-1 / speed) * pull;
  for (uint32_t p = 0; p < contact_colours_.back(); ++p) {
    const ContactPack<T>& c = contacts_[p];
    for (int k = 0; k < Wide<T>::kLanes; ++k) {
      // Separated by more than the fall of one small step, or about to hit: not a bearing.
      if (!(c.point[0].normal_mass[k] > 0) || c.point[0].separation[k] > h * speed) continue;
      const T *a = rows_.data() + 8 * static_cast<size_t>(c.a[k]),
              *b = rows_.data() + 8 * static_cast<size_t>(c.b[k]);
      const Vec2 n{c.nx[k], c.ny[k]};
      if (std::abs(flat::dot(n, Vec2{b[0] - a[0], b[1] - a[1]})) > 2 * speed) continue;
      const double lean = flat::dot(up, n);
      const uint32_t upper = lean > 0 ? c.b[k] : c.a[k], lower = lean > 0 ? c.a[k] : c.b[k];
      if (upper >= moved_ || std::abs(lean) < kCarries) continue;
      const double height = flat::dot(up, pairs.pose[movers_[upper]].p);
      bearings_.push_back({upper, lower, p, k, std::abs(lean), height});
    }
  }
  std::sort(bearings_.begin(), bearings_.end(), [](const Bearing& a, const Bearing& b) {
    if (a.height != b.height) return a.height > b.height;
    if (a.upper != b.upper) return a.upper < b.upper;
    return a.pack != b.pack ? a.pack < b.pack : a.lane < b.lane;
  });
}

template <class T>
void Solver<T>::start_contacts(const Pairs& pairs, double h) {
  list_bearings(pairs, h);
  if (bearings_.empty()) return;
  seats_.assign(movers_.size() + 1, {});
  for (size_t r = 0; r < moved_; ++r) {
    seats_[r].load = flat::norm(Vec2{push_[8 * r], push_[8 * r + 1]}) / static_cast<double>(rows_[8 * r + 3]);
  }
  find_balance();
  for (const Bearing& b : bearings_) {
    if (!parts_[b.upper]) continue;
    const double normal = seats_[b.upper].load * b.lean / seats_[b.upper].share;
    const std::array<double, 2> part = parts_of(b);
    ContactPack<T>& c = contacts_[b.pack];
    double offset[2] = {};
    for (int i = 0; i < 2 && c.point[i].normal_mass[b.lane] > 0; ++i) {
      auto& p = c.point[i];
      p.normal.set(b.lane, static_cast<T>(normal * part[i]));
      // Equilibrium of the soft constraint:  x (1 - scale) = -mass scale bias_rate C.
      offset[i] = normal * part[i] * (1 - static_cast<double>(c.mass_scale[b.lane])) /
                  static_cast<double>(c.mass_scale[b.lane] * c.bias_rate[b.lane] * p.normal_mass[b.lane]);
    }
    // Two equally loaded points share one offset, unless one yields much more than the other because the
    // centre of a body lies outside them: both would begin to tilt.
    if (part[0] == part[1] && std::abs(offset[0] - offset[1]) <= kAlike * std::max(offset[0], offset[1])) {
      offset[0] = offset[1] = 0.5 * offset[0] + 0.5 * offset[1];
    }
    for (int i = 0; i < 2 && c.point[i].normal_mass[b.lane] > 0; ++i) {
      auto& p = c.point[i];
      p.separation.set(b.lane, p.separation[b.lane] - static_cast<T>(offset[i]));
    }
  }
}

template <class T>
double Solver<T>::across(const Bearing& b, uint32_t body, int i) const {
  const ContactPack<T>& c = contacts_[b.pack];
  const auto& p = c.point[i];
  const bool first = body == static_cast<uint32_t>(c.a[b.lane]);
  const double speed = flat::norm(Vec2{push_[0], push_[1]});
  return (-push_[1] * static_cast<double>(first ? p.ax[b.lane] : p.bx[b.lane]) +
          push_[0] * static_cast<double>(first ? p.ay[b.lane] : p.by[b.lane])) /
         speed;
}

template <class T>
std::array<double, 2> Solver<T>::parts_of(const Bearing& b) const {
  if (!(contacts_[b.pack].point[1].normal_mass[b.lane] > 0)) return {1, 0};
  const Seat& on = seats_[b.upper];
  const double x0 = across(b, b.upper, 0), x1 = across(b, b.upper, 1);
  if (on.bearings > 1 || x0 == x1 || !(on.load > 0)) return {0.5, 0.5};
  const double first = std::clamp((x1 - on.moment / on.load) / (x1 - x0), 0.0, 1.0);
  return {first, 1 - first};
}

template <class T>
void Solver<T>::find_balance() {
  for (const Bearing& b : bearings_) seats_[b.upper].share += b.lean * b.lean, ++seats_[b.upper].bearings;
  for (const Bearing& b : bearings_) {
    Seat &on = seats_[b.upper], &under = seats_[b.lower];
    const std::array<double, 2> part = parts_of(b);
    double middle = 0;
    for (int i = 0; i < 2 && contacts_[b.pack].point[i].normal_mass[b.lane] > 0; ++i) {
      const double x = across(b, b.upper, i);
      on.low = std::min(on.low, x), on.high = std::max(on.high, x);
      middle += part[i] * across(b, b.lower, i);
    }
    const double handed = on.load * b.lean * b.lean / on.share;
    under.load += handed, under.moment += handed * middle;
  }
  start_islands(island_);
  for (const Bearing& b : bearings_) {
    if (b.lower < moved_) link_islands(island_, b.upper, b.lower);
  }
  std::fill(parts_.begin(), parts_.end(), uint8_t{1});
  for (uint32_t r = 0; r < moved_; ++r) {
    const Seat& on = seats_[r];
    const double slack = 1e-3 * (on.high - on.low);
    parts_[r] = on.high < on.low ||
                (on.moment >= (on.low - slack) * on.load && on.moment <= (on.high + slack) * on.load);
  }
  spread_minimum<uint8_t>(island_, {parts_.data(), island_.size()});
}

template void Solver<float>::start_contacts(const Pairs&, double);
template void Solver<double>::start_contacts(const Pairs&, double);

}  // namespace truestep::rigid2d
