// Initial impulses of a scene. Substeps carry loads on from the previous one; the first has none, and a
// sweep passes a load on by only a row or two: a tall pile would sink before its lowest contacts felt its
// top. Where no contact continues another, loads are passed down once, from the highest body to the lowest:
// the load and weight of a body are shared by the contacts below it as  N_c = load cos_c / sum cos^2  (cos
// between normal and vertical), by the two points of a single contact as by a lever, and the offsets of their
// points start at the corresponding yield. Exact for stacks, close for piles of boxes; the sweeps correct the
// rest. Islands with a body whose load lies outside its support start at zero: they topple, and loaded
// springs would throw them up. Where this does not hold everything (arches, wedges, cards that lean on one
// another), sweeps with all bodies treated as at rest add what is missing; an island that they hold starts
// with the yields under these loads.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/rigid/islands.h"
#include "engine/systems/rigid2d/solver/solver_contact.h"

namespace truestep::rigid2d {
namespace {

/// Contacts steeper than this (cosine between normal and vertical) carry nothing at the start.
constexpr double kCarries = 0.3;
/// Offsets of two equally loaded points are merged where they differ by no more than this fraction: those of
/// a tower whose boxes stand in line to a thousandth.
constexpr double kAlike = 1e-3;
/// Maximum numbers of sweeps for loads that are not passed down and of packs that they may process in all,
/// and the sweeps between two checks of the residual.
constexpr size_t kLoadSweeps = 2000, kLoadPacks = 200'000, kSweepsPerLook = 50;
/// Fraction of the velocity that forces add in a substep that may remain in a supported body, and the
/// multiple at which the body may already move.
constexpr double kHeld = 0.01, kStill = 2;
/// Sweeps end where this fraction remains, or where a check finds the sum of squares hardly smaller.
constexpr double kBalanced = 1e-4, kHardly = 0.995;
/// Largest offset of an island held by sweeps, as a fraction of the smaller body's inner radius: loaded
/// springs store energy.
constexpr double kMostStart = 0.02;
/// m/s, largest speed at which the springs of a contact could throw the lighter of its bodies out of it: a
/// plate that bears thousands of times its weight would leave faster than anything here falls.
constexpr double kMostThrow = 6;
/// Multiple of the scalar's epsilon by which offsets stay below the yields: with offsets that are larger by
/// rounding bodies would be lifted, by a nanometre in single precision.
constexpr double kBelowYield = 512;

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
      // Separated by more than the fall of one substep, or about to hit: not a bearing.
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
void Solver<T>::start_contacts(const Model& model, const Pairs& pairs, const SolverSettings& settings,
                               const ThreadArena& arena) {
  list_bearings(pairs, settings.h);
  if (bearings_.empty()) return;
  seats_.assign(movers_.size() + 1, {});
  for (size_t r = 0; r < moved_; ++r) {
    seats_[r].load = flat::norm(Vec2{push_[8 * r], push_[8 * r + 1]}) / static_cast<double>(rows_[8 * r + 3]);
  }
  find_balance();
  loads_.assign(bearings_.size(), {});
  for (size_t i = 0; i < bearings_.size(); ++i) {
    const Bearing& b = bearings_[i];
    if (!parts_[b.upper]) continue;
    const double normal = seats_[b.upper].load * b.lean / seats_[b.upper].share;
    const std::array<double, 2> part = parts_of(b);
    ContactPack<T>& c = contacts_[b.pack];
    for (size_t k = 0; k < 2 && c.point[k].normal_mass[b.lane] > 0; ++k) {
      loads_[i][k] = normal * part[k];
      c.point[k].normal.set(b.lane, static_cast<T>(loads_[i][k]));
    }
  }
  balanced_ = parts_;
  sweep_loads(settings, arena);
  for (size_t i = 0; i < bearings_.size(); ++i) {
    const Bearing& b = bearings_[i];
    if (!balanced_[b.upper] || parts_[b.upper]) continue;
    const ContactPack<T>& c = contacts_[b.pack];
    double offset[2] = {yields(c, b.lane, 0, loads_[i][0]), yields(c, b.lane, 1, loads_[i][1])};
    // Two equally loaded points share one offset unless one yields more than the other, because the centres
    // of the bodies are not in line: both would begin to tilt.
    if (loads_[i][0] == loads_[i][1] &&
        std::abs(offset[0] - offset[1]) <= kAlike * std::max(offset[0], offset[1])) {
      offset[0] = offset[1] = 0.5 * offset[0] + 0.5 * offset[1];
    }
    const double lightest = std::max(rows_[8 * static_cast<size_t>(c.a[b.lane]) + 3],
                                     rows_[8 * static_cast<size_t>(c.b[b.lane]) + 3]);  // 1/kg
    const double thrown2 =
        (loads_[i][0] * offset[0] + loads_[i][1] * offset[1]) / settings.h * lightest;  // m^2/s^2
    const double share = thrown2 > kMostThrow * kMostThrow ? kMostThrow * kMostThrow / thrown2 : 1;
    offset[0] *= share, offset[1] *= share;
    begin_with(b.pack, b.lane, offset);
  }
  for (uint32_t p = 0; p < contact_colours_.back(); ++p) {
    const ContactPack<T>& c = contacts_[p];
    for (int lane = 0; lane < Wide<T>::kLanes; ++lane) {
      const uint32_t body = std::min(c.a[lane], c.b[lane]);
      if (body >= moved_ || !parts_[body]) continue;
      double offset[2], inner = HUGE_VAL;
      for (int i = 0; i < 2; ++i) offset[i] = yields(c, lane, i, c.point[i].normal[lane]);
      for (const uint32_t row : {c.a[lane], c.b[lane]}) {
        if (row < moved_) inner = std::min(inner, model.light[movers_[row]].inner);
      }
      const double most = std::max(offset[0], offset[1]);
      const double share = most > kMostStart * inner ? kMostStart * inner / most : 1;
      offset[0] *= share, offset[1] *= share;
      begin_with(p, lane, offset);
    }
  }
}

template <class T>
double Solver<T>::yields(const ContactPack<T>& c, int lane, int point, double load) const {
  const auto& p = c.point[point];
  if (!(p.normal_mass[lane] > 0)) return 0;
  // Equilibrium of the soft constraint:  x (1 - scale) = -mass scale bias_rate C.
  return load * (1 - static_cast<double>(c.mass_scale[lane])) /
         static_cast<double>(c.mass_scale[lane] * c.bias_rate[lane] * p.normal_mass[lane]);
}

template <class T>
void Solver<T>::begin_with(uint32_t pack, int lane, const double offset[2]) {
  constexpr double kShare = 1 - kBelowYield * std::numeric_limits<T>::epsilon();
  for (int i = 0; i < 2; ++i) {
    auto& p = contacts_[pack].point[i];
    if (!(p.normal_mass[lane] > 0)) continue;
    p.separation.set(lane, p.separation[lane] - static_cast<T>(kShare * offset[i]));
  }
}

template <class T>
double Solver<T>::find_held(std::vector<uint8_t>& held) {
  // Rotation counts by the radius of gyration.
  const auto size = [](const T* v, const T* row) {
    const double turn = row[7] > 0 ? double(v[2]) * double(v[2]) * double(row[3]) / double(row[7]) : 0;
    return std::sqrt(double(v[0]) * double(v[0]) + double(v[1]) * double(v[1]) + turn);
  };
  double pull = 0, squares = 0;
  for (size_t r = 0; r < moved_; ++r) pull = std::max(pull, size(&push_[8 * r], &rows_[8 * r]));
  held.assign(island_.size(), 1);
  for (size_t r = 0; r < moved_; ++r) {
    const T *v = &start_[8 * r], *free = &push_[8 * r], *row = &rows_[8 * r];
    const double left = size(v, row) / pull;
    held[r] = left <= kHeld && size(row, row) <= kStill * pull;
    if (!std::equal(v, v + 3, free)) squares += left * left;
  }
  spread_minimum<uint8_t>(island_, held);
  return squares;
}

template <class T>
void Solver<T>::sweep_loads(const SolverSettings& settings, const ThreadArena& arena) {
  const uint32_t packs = contact_colours_.back();
  // As if everything were at rest: velocities are what forces add in a substep and contacts remove.
  std::copy(rows_.begin(), rows_.end(), start_.begin());
  for (size_t r = 0; r < movers_.size(); ++r) {
    for (size_t k = 0; k < 3; ++k) start_[8 * r + k] = r < moved_ ? push_[8 * r + k] : T(0);
  }
  for (uint32_t p = 0; p < packs; ++p) {
    remember_impulses(contacts_[p]);
    warm_start(contacts_[p], start_.data(), moved_);
  }
  find_islands();
  find_held(held_before_);
  held_now_ = held_before_;
  if (std::find(held_now_.begin(), held_now_.end(), 0) != held_now_.end()) {
    const T inverse_h = static_cast<T>(1 / settings.h);
    const T push_out_speed = static_cast<T>(settings.push_out_speed);
    const size_t sweeps = std::min<size_t>(kLoadSweeps, kLoadPacks / packs);
    double last = HUGE_VAL;
    for (size_t k = 0; k < sweeps; ++k) {
      each_colour(contact_colours_, k % 2 == 0 ? ColourOrder::forth : ColourOrder::back, arena, kPacksPerTask,
                  [&](size_t p) {
                    solve_contacts<Pass::relax>(contacts_[p], start_.data(), moved_, inverse_h,
                                                push_out_speed, static_cast<const T*>(nullptr));
                  });
      if ((k + 1) % kSweepsPerLook != 0) continue;
      const double left = find_held(held_now_);
      if (left <= kBalanced * kBalanced || left > kHardly * last) break;
      last = left;
    }
    find_held(held_now_);
  }
  for (size_t r = 0; r < parts_.size(); ++r) parts_[r] = held_now_[r] && !held_before_[r];
  for (uint32_t p = 0; p < packs; ++p) {
    ContactPack<T>& c = contacts_[p];
    for (int lane = 0; lane < Wide<T>::kLanes; ++lane) {
      const uint32_t body = std::min(c.a[lane], c.b[lane]);
      if (body < moved_ && parts_[body]) continue;
      for (int i = 0; i < 2; ++i) {
        c.point[i].normal.set(lane, c.before.normal[i][lane]);
        c.point[i].tangent.set(lane, c.before.tangent[i][lane]);
      }
      c.rolling_impulse.set(lane, c.before.rolling[lane]);
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

template void Solver<float>::start_contacts(const Model&, const Pairs&, const SolverSettings&,
                                            const ThreadArena&);
template void Solver<double>::start_contacts(const Model&, const Pairs&, const SolverSettings&,
                                             const ThreadArena&);

}  // namespace truestep::rigid2d
