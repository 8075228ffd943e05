#include "engine/couplings/attachment/attachment.h"

#include <cmath>
#include <map>

#include "engine/couplings/attachment/body_attachment.h"
#include "engine/couplings/attachment/link_work.h"
#include "engine/couplings/attachment/links.h"
#include "engine/couplings/sides.h"

namespace truestep::attachment {

namespace {

constexpr const char* kStart = "attachment.start";

/// Id of the point with an index from the scene.
uint64_t named_point(int64_t index, const CouplingSide& side, const PointPort& columns,
                     const std::string& pointer) {
  const ConstPoints points(side.state, columns);
  const auto n = static_cast<int64_t>(points.count);
  const int64_t row = index < 0 ? n + index : index;
  if (row < 0 || row >= n) {
    const std::string why = "\"" + side.id + "\" has " + std::to_string(n) + " points at t = 0";
    throw Error(
        "scene_invalid", why,
        {pointer, "out_of_range", why, std::to_string(index),
         n > 0 ? std::to_string(-n) + " to " + std::to_string(n - 1) : "there is no such point", "", ""});
  }
  return points.ids.empty() ? static_cast<uint64_t>(row) : points.ids[static_cast<size_t>(row)];
}

}  // namespace

std::unique_ptr<const Attachment> Attachment::make(const AttachmentDef& def, const CouplingContext& context) {
  const PointPort a = require_points(context.a, "a"), b = require_points(context.b, "b");
  std::unique_ptr<Attachment> out(new Attachment(def, context, a, b));
  const ConstPoints pa(context.a.state, a), pb(context.b.state, b);
  std::map<uint64_t, double> a_pairs, b_pairs;
  const bool same = &context.a.system == &context.b.system;
  for (size_t k = 0; k < def.a_points.size(); ++k) {
    const std::string at = "/" + std::to_string(k);
    Pair p{};
    p.a = named_point(def.a_points[k], context.a, a, "/a_points" + at);
    p.b = named_point(def.b_points[k], context.b, b, "/b_points" + at);
    if (same && p.a == p.b) {
      const std::string why = "a pair needs two different points";
      throw Error("scene_invalid", why, {"/b_points" + at, "inconsistent", why, "", "", "", ""});
    }
    const Vec3 r = separation(pa, *pa.row_of(p.a), pb, *pb.row_of(p.b));
    p.rest = def.rest_length.value_or(norm(r));
    ++a_pairs[p.a];
    ++(same ? a_pairs : b_pairs)[p.b];
    out->pairs_.push_back(p);
  }
  for (Pair& p : out->pairs_) p.a_share = a_pairs[p.a], p.b_share = (same ? a_pairs : b_pairs)[p.b];
  return out;
}

template <class Real>
void Attachment::collect(const PointsOf<Real>& a, const PointsOf<Real>& b, std::vector<Live>& out) const {
  out.clear();
  for (size_t k = 0; k < pairs_.size(); ++k) {
    const auto i = a.row_of(pairs_[k].a), j = b.row_of(pairs_[k].b);
    if (!i || !j) continue;
    const double wa = a.inverse_mass(*i), wb = b.inverse_mass(*j);
    if (wa + wb > 0) out.push_back({k, *i, *j, wa, wb, pairs_[k].rest});
  }
}

std::vector<Attachment::Live>& Attachment::live_pairs(const Points& a, const Points& b, const StepInput& in,
                                                      Wanted wanted) const {
  auto& live = in.workspace.object<std::vector<Live>>(wanted == Wanted::solved ? "attachment.stiff"
                                                                               : "attachment.live");
  collect(a, b, live);
  if (wanted == Wanted::links) return live;
  std::erase_if(live, [&](const Live& p) { return is_solved(p, in.h) != (wanted == Wanted::solved); });
  return live;
}

bool Attachment::is_solved(const Live& p, double h) const {
  const Pair& pair = pairs_[p.pair];
  const double pull = def_.stiffness * (pair.a_share * p.wa + pair.b_share * p.wb);
  return h * h * pull > (answered_.any() ? kMostKickedTogether : kMostKicked);
}

void Attachment::begin(const CoupledStates& s, const StepInput& in) const {
  const ProfileScope scope(in.profile, pass());
  Points a(s.a, a_), b(s.b, b_);
  if (def_.link == AttachmentDef::Link::rigid) {
    const auto& live = live_pairs(a, b, in, Wanted::links);
    if (answered_.any()) return give_last(s, in.h, a, b, live);
    double* start = in.workspace.doubles(kStart, 3 * pairs_.size()).data();
    for (const Live& p : live) store3(start, p.pair, separation(a, p.a, b, p.b));
    return;
  }
  give_last(s, in.h, a, b, live_pairs(a, b, in, Wanted::solved));
  const auto& live = live_pairs(a, b, in, Wanted::kicked);
  Exchange sum;
  pull(a, b, live, 0.5 * in.h, sum);
  damp(a, b, live, 0.5 * in.h, sum);
  book(s.own, sum);
}

void Attachment::end(const CoupledStates& s, const StepInput& in) const {
  const ProfileScope scope(in.profile, pass());
  Points a(s.a, a_), b(s.b, b_);
  Exchange sum;
  if (def_.link == AttachmentDef::Link::rigid) {
    const auto& live = live_pairs(a, b, in, Wanted::links);
    if (answered_.any()) {
      solve_pairs(s, in, live, sum);
    } else {
      const double* start = in.workspace.doubles(kStart, 3 * pairs_.size()).data();
      restore_lengths(a, b, live, start, in.h, sum);
    }
    match_velocities(a, b, live, sum);
  } else {
    solve_pairs(s, in, live_pairs(a, b, in, Wanted::solved), sum);
    const auto& live = live_pairs(a, b, in, Wanted::kicked);
    damp(a, b, live, 0.5 * in.h, sum);
    pull(a, b, live, 0.5 * in.h, sum);
  }
  book(s.own, sum);
}

// J = -half k (|r| - L) n; with L = 0 it needs no direction.
void Attachment::pull(Points& a, Points& b, const std::vector<Live>& live, double half, Exchange& sum) const {
  for (const Live& p : live) {
    const Vec3 r = separation(a, p.a, b, p.b);
    const Vec3 stretch = p.rest == 0 ? r : r - normalized(r) * p.rest;
    const Vec3 impulse = stretch * (-half * def_.stiffness);
    exchange_impulse(a, p.a, p.wa, b, p.b, p.wb, impulse);
    sum.add(impulse, 0);
  }
}

// du/dt = -c K u along n (coinciding points: in every direction) by the trapezoid rule: u' = u (1 - q) / (1 +
// q), q = c K half / 2.
void Attachment::damp(Points& a, Points& b, const std::vector<Live>& live, double half, Exchange& sum) const {
  if (def_.damping == 0) return;
  for (const Live& p : live) {
    const Vec3 r = separation(a, p.a, b, p.b), u = approach(a, p.a, b, p.b);
    const Vec3 along = norm2(r) > 0 ? r * (dot(u, r) / norm2(r)) : u;
    const double k = p.wa + p.wb, q = 0.5 * def_.damping * k * half;
    const Vec3 impulse = along * (-2 * q / ((1 + q) * k));
    exchange_impulse(a, p.a, p.wa, b, p.b, p.wb, impulse);
    sum.add(impulse, -dot(impulse, along + impulse * (0.5 * k)));
  }
}

// SHAKE's part: every position correction also changes the velocity, by 1/h times as much.
void Attachment::restore_lengths(Points& a, Points& b, const std::vector<Live>& live, const double* start,
                                 double h, Exchange& sum) {
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double worst = 0;
    for (const Live& p : live) {
      const Vec3 r = separation(a, p.a, b, p.b);
      const Vec3 dr = length_correction(r, load3(start, p.pair), p.rest);
      worst = std::max(worst, norm(dr) / std::max(p.rest, 1.0));
      const Vec3 share = dr / (p.wa + p.wb);
      exchange_shift(a, p.a, p.wa, b, p.b, p.wb, share);
      exchange_impulse(a, p.a, p.wa, b, p.b, p.wb, share / h);
      sum.add(share / h, 0);
    }
    if (worst <= kLengthTolerance) break;
  }
}

// RATTLE's part: u.n = 0.
void Attachment::match_velocities(Points& a, Points& b, const std::vector<Live>& live, Exchange& sum) {
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double worst = 0, fastest = 0;
    for (const Live& p : live) {
      const Vec3 n = normalized(separation(a, p.a, b, p.b)), u = approach(a, p.a, b, p.b);
      const Vec3 along = p.rest == 0 ? u : n * dot(u, n), impulse = along / -(p.wa + p.wb);
      worst = std::max(worst, norm(along));
      fastest = std::max(fastest, norm(u));
      exchange_impulse(a, p.a, p.wa, b, p.b, p.wb, impulse);
      sum.add(impulse, -0.5 * dot(impulse, along));
    }
    if (worst <= kLengthTolerance * fastest) break;
  }
}

State Attachment::initial_state() const {
  State s = exchange_state();
  if (answered_.any()) s.add({kPairForce, "N", Scalar::f64, 6}, pairs_.size());
  return s;
}

void Attachment::observe(const ConstCoupledStates& s, Observables& out) const {
  const ConstPoints a(s.a, a_), b(s.b, b_);
  std::vector<Live> live;
  collect(a, b, live);
  double error = 0;
  for (const Live& p : live) error = std::max(error, std::abs(norm(separation(a, p.a, b, p.b)) - p.rest));
  observe_exchange(s.own, out);
  if (def_.link == AttachmentDef::Link::spring) {
    out.add("energy.potential", stored_energy(s), "J");
  } else {
    out.add("length.error", error, "m");
  }
  out.add("pairs", static_cast<double>(live.size()), "1");
}

void Attachment::draw(const ConstCoupledStates& s, std::vector<DrawnString>& out) const {
  const ConstPoints a(s.a, a_), b(s.b, b_);
  for (const Pair& p : pairs_) {
    const auto i = a.row_of(p.a), j = b.row_of(p.b);
    if (i && j) out.push_back({{0, static_cast<uint32_t>(*i), {}}, {1, static_cast<uint32_t>(*j), {}}});
  }
}

double Attachment::stored_energy(const ConstCoupledStates& s) const {
  if (def_.link != AttachmentDef::Link::spring) return 0;
  const ConstPoints a(s.a, a_), b(s.b, b_);
  double stored = 0;
  for (const Pair& p : pairs_) {
    const auto i = a.row_of(p.a), j = b.row_of(p.b);
    if (!i || !j || !(a.inverse_mass(*i) + b.inverse_mass(*j) > 0)) continue;
    const double stretch = norm(separation(a, *i, b, *j)) - p.rest;
    stored += 0.5 * def_.stiffness * stretch * stretch;
  }
  return stored;
}

// One matrix a substep; what was given at its start is answered, and the impulses found move both sides.
std::optional<double> Attachment::step_seconds(const ConstCoupledStates& s, double h) const {
  const ConstPoints a(s.a, a_), b(s.b, b_);
  std::vector<Live> live;
  collect(a, b, live);
  const bool rigid = def_.link == AttachmentDef::Link::rigid;
  if (!rigid) std::erase_if(live, [&](const Live& p) { return !is_solved(p, h); });
  const auto solved = static_cast<double>(live.size());
  double seconds = kKickSeconds * static_cast<double>(pairs_.size()) + kSweepSeconds * solved;
  if (live.empty() || !answered_.any()) return seconds;
  double directions = 0;
  for (const Live& p : live) directions += rigid && p.rest > 0 ? 1 : 3;
  const auto answer = answered_.answer_seconds();
  const double again =
      kDirections * asked(directions) + 1 + (rigid ? kClosings * (asked(directions) + 1) : 0);
  return seconds + answer.first + again * answer.again;
}

std::vector<PlanRow> Attachment::plan() const {
  using enum PlanRow::Status;
  const std::string count = std::to_string(pairs_.size()) + (pairs_.size() == 1 ? " pair" : " pairs");
  if (def_.link == AttachmentDef::Link::rigid) {
    const char* together = answered_.any() ? ", solved together with everything attached to them" : "";
    return {{runs, pass(), count + " of points at a fixed distance" + together},
            {skipped, "damping", "rigid links have none"}};
  }
  std::vector<PlanRow> rows{{runs, pass(),
                             count + " of points, a kick at both ends of the substep; stiff ones solved "
                                     "together with everything attached to them"}};
  if (def_.damping > 0) {
    rows.push_back({runs, "damping", "along the pairs"});
  } else {
    rows.push_back({skipped, "damping", "damping is 0"});
  }
  return rows;
}

std::unique_ptr<const Coupling> build_attachment(const void* def, const CouplingContext& context) {
  const auto& d = *static_cast<const AttachmentDef*>(def);
  const bool a = context.a.system.ports().bodies.has_value(), b = context.b.system.ports().bodies.has_value();
  if (a != b) return BodyAttachment::make(d, context);
  if (a) {
    const std::string why = "bodies of two systems cannot be attached to each other";
    throw Error("scene_invalid", why,
                {{"/b", "unsuitable_system", why, '"' + context.b.id + '"',
                  "a system of points (mass_spring, particles) on one side; bodies of one system take joints",
                  "", ""}});
  }
  if (!d.places.empty()) {
    const std::string why = "places need a system of bodies";
    throw Error("scene_invalid", why,
                {"/places", "unsuitable_system", why, "", "places on bodies of rigid3d", "", ""});
  }
  return Attachment::make(d, context);
}

}  // namespace truestep::attachment
