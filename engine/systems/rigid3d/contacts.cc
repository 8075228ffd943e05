#include "engine/systems/rigid3d/contacts.h"

#include <algorithm>
#include <cmath>

#include "engine/base/random.h"
#include "engine/rigid/toi_clamp.h"

namespace truestep::rigid3d {

namespace {

constexpr size_t kPairsPerBlock = 128;
/// Contacts begin at this fraction of a body's size, at most at kMostMargin.
constexpr double kMarginShare = 0.005, kMostMargin = 0.02;
/// Smallest cosine between the normals of a contact that continues although no point kept its id.
constexpr double kSameNormal = 0.98;

using Part = BodyNow::Part;

bool touch_allowed(const BodyKind& a, const BodyKind& b) {
  return filter_allows(a, b) && (a.moved_by_forces() || b.moved_by_forces());
}

/// There is then no direction in which to separate them.
bool balls_at_one_place(const Solid& a, const Transform& at_a, const Solid& b, const Transform& at_b) {
  return a.kind == SolidKind::sphere && b.kind == SolidKind::sphere &&
         norm(at_b.position - at_a.position) <= 1e-12 * b.size.x;
}

/// A direction of its own for every pair: with one for all, many balls form a line that hardly separates.
void part_anywhere(const Vec3& place, Contact& c) {
  const auto u = uniform4(0, c.a, c.b);
  const Vec3 d{u[0] - 0.5, u[1] - 0.5, u[2] - 0.5};
  const double l = norm(d);
  if (!(l > 0)) return;
  const double along = dot(c.manifold.points[0].position - place, c.manifold.normal);
  c.manifold.normal = d / l;
  c.manifold.points[0].position = place + c.manifold.normal * along;
}

}  // namespace

void ContactList::update_bounds(const State& s, std::span<const BodyKind> kinds, const StepInput& in,
                                double ahead, double thinnest) {
  const double h = in.h;
  const size_t n = s.rows(columns::position);
  const double *x = s.f64(columns::position).data(), *q = s.f64(columns::orientation).data();
  const double *v = s.f64(columns::velocity).data(), *w = s.f64(columns::angular_velocity).data();
  const auto kind = s.span<uint32_t>(columns::kind);
  const auto asleep = s.span<uint32_t>(columns::asleep);
  const double* rested = s.f64(columns::sleep_timer).data();
  const double fall = norm(load3(s.f64(columns::gravity).data(), 0)) * h * h;
  bodies_.resize(n), boxes_.resize(n), mobility_.resize(n);
  const double seen2 = ahead > 0 ? 0.25 * kSeenMotion * kSeenMotion / (ahead * ahead) : HUGE_VAL;
  moves_ = false;
  for (size_t i = 0; i < n; ++i) {
    const BodyKind& k = kinds[kind[i]];
    BodyNow& b = bodies_[i];
    b.at = transform_of({load3(x, i), load_quat(q, i)});
    const Vec3 velocity = load3(v, i), turn = load3(w, i);
    // A belt keeps its load awake, as a moving body does.
    const bool moves = velocity != Vec3{} || turn != Vec3{} || k.conveys();
    b.part = k.moved_by_forces() && !is_led(rested, i) ? (asleep[i] ? Part::resting : Part::active)
             : moves                                   ? Part::kinematic
                                                       : Part::fixed;
    b.margin = std::min(kMarginShare * k.reach, kMostMargin) + std::abs(k.gravity_scale) * fall;
    // The reach of a plane is infinite.
    b.turn_speed = turn == Vec3{} ? 0 : std::min(norm(turn) * k.reach, k.reach / h);
    b.moves = norm2(velocity) > seen2 * k.reach * k.reach || norm2(turn) > seen2;
    moves_ |= b.moves;
    b.far = moves && may_pass_through(h * (norm(velocity) + b.turn_speed), thinnest);
    mobility_[i] = k.motion == BodyDef::Motion::fixed ? Mobility::fixed : Mobility::moving;
    if ((k.mask == 0 || k.category == 0) && k.group <= 0) {
      boxes_[i] = Box::nothing();
      continue;
    }
    Box box = bounds(k.solid, b.at);
    if (k.motion != BodyDef::Motion::fixed) {
      box = box.grown(b.margin + h * b.turn_speed);
      const Vec3 move = velocity * h;
      (move.x < 0 ? box.low.x : box.high.x) += move.x;
      (move.y < 0 ? box.low.y : box.high.y) += move.y;
      (move.z < 0 ? box.low.z : box.high.z) += move.z;
    }
    boxes_[i] = box;
  }
}

void ContactList::narrow_phase(const State& s, std::span<const BodyKind> kinds, const StepInput& in,
                               double ahead) {
  const auto kind = s.span<uint32_t>(columns::kind);
  const double* v = s.f64(columns::velocity).data();
  pairs_.clear();
  const double fat = 0.05;
  for (const BodyPair& p : broad_.update(boxes_, mobility_, fat)) {
    const bool active = bodies_[p.a].part == Part::active || bodies_[p.b].part == Part::active ||
                        bodies_[p.a].part == Part::kinematic || bodies_[p.b].part == Part::kinematic;
    if (!active || !touch_allowed(kinds[kind[p.a]], kinds[kind[p.b]])) continue;
    if (joined(p.a, p.b)) continue;
    pairs_.push_back(p);
  }
  bears_.clear();
  if (moves_) find_bearing(s);
  if (moves_ && seams_possible_) look_at_seams_now(s, kinds);
  const size_t blocks = (pairs_.size() + kPairsPerBlock - 1) / kPairsPerBlock;
  if (blocks_.size() < blocks) blocks_.resize(blocks), manifolds_.resize(blocks);
  in.arena.for_blocks(pairs_.size(), kPairsPerBlock, [&](size_t begin, size_t end) {
    std::vector<Contact>& out = blocks_[begin / kPairsPerBlock];
    std::vector<Manifold>& several = manifolds_[begin / kPairsPerBlock];
    out.clear();
    Outlook later;
    for (size_t p = begin; p < end; ++p) {
      const auto [a, b] = pairs_[p];
      const BodyKind &ka = kinds[kind[a]], &kb = kinds[kind[b]];
      const BodyNow &na = bodies_[a], &nb = bodies_[b];
      later.ahead = 0;
      if (!bears_.empty() && bears_[p]) look_ahead(s, kinds, pairs_[p], ahead, later);
      const Transform &at_a = later.ahead > 0 ? later.a : na.at, &at_b = later.ahead > 0 ? later.b : nb.at;
      double margin = na.gives_way() ? na.margin : nb.margin;
      if (nb.gives_way()) margin = std::min(margin, nb.margin);
      // With a margin larger than its own size, a body would touch planes next to those that it meets.
      const double size =
          na.gives_way() ? (nb.gives_way() ? std::min(ka.reach, kb.reach) : ka.reach) : kb.reach;
      margin += std::min(in.h * (norm(load3(v, b) - load3(v, a)) + na.turn_speed + nb.turn_speed), size);
      if (ka.sensor || kb.sensor) margin = 0;
      const bool far = na.far || nb.far;
      const double still =
          std::min(na.gives_way() ? na.margin : HUGE_VAL, nb.gives_way() ? nb.margin : HUGE_VAL);
      if (is_convex_or_plane(ka.solid.kind) && is_convex_or_plane(kb.solid.kind)) {
        Contact& c = out.emplace_back();
        c.a = a, c.b = b;
        if (!collide(ka.solid, at_a, kb.solid, at_b, margin, c.manifold) &&
            !(far && meet(s, kinds, pairs_[p], in.h, later) &&
              collide(ka.solid, later.a, kb.solid, later.b, std::max(still, size), c.manifold))) {
          out.pop_back();
          continue;
        }
        if (balls_at_one_place(ka.solid, at_a, kb.solid, at_b)) part_anywhere(at_a.position, c);
        if (later.ahead > 0) bring_back(c, later);
      } else {
        several.clear();
        if (collide(ka.solid, at_a, kb.solid, at_b, margin, several) == 0 && far &&
            meet(s, kinds, pairs_[p], in.h, later)) {
          collide(ka.solid, later.a, kb.solid, later.b, still, several);
        }
        for (const Manifold& m : several) {
          Contact& c = out.emplace_back();
          c.a = a, c.b = b, c.manifold = m;
          if (later.ahead > 0) bring_back(c, later);
        }
      }
    }
  });
  contacts_.clear();
  for (size_t k = 0; k < blocks; ++k) {
    for (Contact& c : blocks_[k]) contacts_.push_back(&c);
  }
  if (std::none_of(kinds.begin(), kinds.end(), [](const BodyKind& k) { return k.one_way; })) return;
  std::erase_if(contacts_, [&](const Contact* c) {
    const BodyKind &a = kinds[kind[c->a]], &b = kinds[kind[c->b]];
    const double at_a = a.moved_by_forces() ? bodies_[c->a].margin : HUGE_VAL,
                 at_b = b.moved_by_forces() ? bodies_[c->b].margin : HUGE_VAL;
    return !a.sensor && !b.sensor && passes(s, kinds, {c->a, c->b}, c->manifold, std::min(at_a, at_b));
  });
}

/// Wakes sleeping bodies that an awake body touches; returns whether there were any.
bool ContactList::wake(State& s, std::span<const BodyKind> kinds) {
  const auto asleep = s.span<uint32_t>(columns::asleep);
  bool any = false;
  for (const Contact* c : contacts_) {
    for (const uint32_t i : {c->a, c->b}) {
      if (asleep[i]) wake_body(s, i, kinds), any = true;
    }
  }
  return any;
}

void ContactList::find_joined(const State& s, std::span<const Joint> joints) {
  const auto held = s.span<uint32_t>(columns::joint_bodies), broken = s.span<uint32_t>(columns::joint_broken);
  joined_now_.clear();
  for (size_t k = 0; k < joints.size(); ++k) {
    if (joints[k].collide || broken[k]) continue;
    const auto [low, high] = std::minmax(held[2 * k], held[2 * k + 1]);
    joined_now_.push_back(uint64_t{low} << 32 | high);
  }
  // Usually the same as in the last step.
  if (joined_now_ == joined_before_) return;
  joined_ = joined_now_, joined_before_.swap(joined_now_);
  std::sort(joined_.begin(), joined_.end());
}

void ContactList::find(State& s, const BodyList& list, std::span<const Joint> joints, const StepInput& in,
                       double ahead) {
  const std::span<const BodyKind> kinds = list.kinds;
  find_joined(s, joints);
  seams_possible_ = list.seams;
  update_bounds(s, kinds, in, ahead, list.thinnest);
  narrow_phase(s, kinds, in, ahead);
  if (wake(s, kinds)) {
    update_bounds(s, kinds, in, ahead, list.thinnest);
    narrow_phase(s, kinds, in, ahead);
  }
  if (seams_possible_) leave_out_seams(s, kinds);
  match(s);
}

ContactList::Rows::Rows(const State& s)
    : bodies(s.span<uint32_t>(columns::contact_bodies)),
      ids(s.span<uint32_t>(columns::contact_ids)),
      impulse(s.f64(columns::contact_impulse).data()),
      normal(s.f64(columns::contact_normal).data()),
      friction(s.f64(columns::contact_friction).data()),
      roll(s.f64(columns::contact_roll).data()),
      offset(s.f64(columns::contact_offset).data()),
      uneven(s.f64(columns::contact_uneven).data()) {}

void ContactList::match(const State& s) {
  const Rows old(s);
  const auto& bodies = old.bodies;
  const size_t rows = s.rows(columns::contact_bodies);
  const auto key = [&](size_t r) { return uint64_t{bodies[2 * r]} << 32 | bodies[2 * r + 1]; };
  claimed_.assign(rows, 0);
  size_t row = 0;
  for (size_t k = 0; k < contacts_.size();) {
    const uint64_t pair = uint64_t{contacts_[k]->a} << 32 | contacts_[k]->b;
    while (row < rows && key(row) < pair) ++row;
    size_t rows_end = row, end = k;
    while (rows_end < rows && key(rows_end) == pair) ++rows_end;
    const auto same = [&](const Contact& c) { return (uint64_t{c.a} << 32 | c.b) == pair; };
    while (end < contacts_.size() && same(*contacts_[end])) ++end;
    match_pair(old, {contacts_.data() + k, end - k}, row, rows_end);
    k = end, row = rows_end;
  }
}

/// The contacts of two bodies, with rows [first, end) of the previous step.
void ContactList::match_pair(const Rows& rows, std::span<Contact* const> contacts, size_t first, size_t end) {
  const auto& ids = rows.ids;
  const double *impulse = rows.impulse, *friction = rows.friction, *offset = rows.offset,
               *uneven = rows.uneven;
  const auto go_on = [&](Contact& c, size_t r) {
    c.slide = {friction[4 * r], friction[4 * r + 1], friction[4 * r + 2]};
    c.twist = friction[4 * r + 3], c.penetration_offset = offset[r];
    c.roll = load3(rows.roll, r), claimed_[r] = 1;
  };
  bool strangers = false;
  for (Contact* c : contacts) {
    size_t whole = end;  // the row that continues
    int found = 0;
    double left = 0, lifted = 0;
    bool known[Manifold::kMost] = {};
    for (int p = 0; p < c->manifold.count; ++p) {
      for (size_t r = first; r < end; ++r) {
        const uint32_t* old = &ids[5 * r];
        uint32_t k = 0;
        while (k < old[0] && old[1 + k] != c->manifold.points[p].id) ++k;
        if (k == old[0]) continue;
        c->impulse[p] = impulse[4 * r + k], c->uneven[p] = uneven[4 * r + k], known[p] = true, ++found;
        left -= c->impulse[p], lifted -= c->impulse[p] * c->uneven[p];
        if (whole == end) whole = r;
        break;
      }
    }
    if (whole == end) {
      strangers = true;
      continue;
    }
    go_on(*c, whole);
    // New points take over the load of vanished ones, with its mean offset.
    for (uint32_t k = 0; k < ids[5 * whole]; ++k) {
      const double load = impulse[4 * whole + k];
      left += load, lifted += load * uneven[4 * whole + k];
    }
    const int came = c->manifold.count - found;
    for (int p = 0; p < c->manifold.count && came > 0 && left > 0; ++p) {
      if (known[p]) continue;
      c->impulse[p] = left / came;
      c->uneven[p] = std::clamp(lifted / left, -c->penetration_offset, c->penetration_offset);
    }
  }
  if (!strangers) return;
  // Points change their ids where a face becomes an edge, while the load persists.
  for (Contact* c : contacts) {
    const bool stranger =
        std::all_of(c->impulse, c->impulse + Manifold::kMost, [](double l) { return l == 0; });
    if (!stranger) continue;
    size_t next = end;
    double closest = kSameNormal;
    for (size_t r = first; r < end; ++r) {
      const double along = dot(load3(rows.normal, r), c->manifold.normal);
      if (!claimed_[r] && along > closest) closest = along, next = r;
    }
    if (next == end) continue;
    go_on(*c, next);
    const double* old = impulse + 4 * next;
    const double share = (old[0] + old[1] + old[2] + old[3]) / c->manifold.count;
    std::fill_n(c->impulse, c->manifold.count, share);
  }
}

void ContactList::store(State& s) {
  // Contacts between sleeping bodies are kept unchanged.
  rows_.clear();
  const auto bodies = s.span<uint32_t>(columns::contact_bodies);
  const auto resting = [&](uint32_t i) {
    return bodies_[i].part == Part::resting || bodies_[i].part == Part::fixed;
  };
  for (size_t old = 0; old < s.rows(columns::contact_bodies); ++old) {
    if (!resting(bodies[2 * old]) || !resting(bodies[2 * old + 1])) continue;
    Row& r = rows_.emplace_back();
    std::copy_n(&bodies[2 * old], 2, r.bodies);
    std::copy_n(&s.span<uint32_t>(columns::contact_ids)[5 * old], 5, r.ids);
    std::copy_n(&s.f64(columns::contact_normal)[3 * old], 3, r.normal);
    std::copy_n(&s.f64(columns::contact_impulse)[4 * old], 4, r.impulse);
    std::copy_n(&s.f64(columns::contact_uneven)[4 * old], 4, r.uneven);
    std::copy_n(&s.f64(columns::contact_friction)[4 * old], 4, r.friction);
    std::copy_n(&s.f64(columns::contact_roll)[3 * old], 3, r.roll);
    r.depth = s.f64(columns::contact_depth)[old], r.penetration_offset = s.f64(columns::contact_offset)[old];
  }
  const size_t n = contacts_.size() + rows_.size();
  for (State::Column c = columns::contact_bodies; c < columns::contacts_end; ++c) s.resize(c, n);
  const auto new_bodies = s.span<uint32_t>(columns::contact_bodies);
  const auto new_ids = s.span<uint32_t>(columns::contact_ids);
  const auto normal = s.f64(columns::contact_normal), impulse = s.f64(columns::contact_impulse);
  const auto friction = s.f64(columns::contact_friction), roll = s.f64(columns::contact_roll);
  const auto depth = s.f64(columns::contact_depth), offset = s.f64(columns::contact_offset);
  const auto uneven = s.f64(columns::contact_uneven);
  const auto put_resting = [&](size_t k, const Row& r) {
    std::copy_n(r.bodies, 2, &new_bodies[2 * k]);
    std::copy_n(r.ids, 5, &new_ids[5 * k]);
    std::copy_n(r.normal, 3, &normal[3 * k]);
    std::copy_n(r.impulse, 4, &impulse[4 * k]);
    std::copy_n(r.uneven, 4, &uneven[4 * k]);
    std::copy_n(r.friction, 4, &friction[4 * k]);
    std::copy_n(r.roll, 3, &roll[3 * k]);
    depth[k] = r.depth, offset[k] = r.penetration_offset;
  };
  const auto put = [&](size_t k, const Contact& c) {
    const Manifold& m = c.manifold;
    new_bodies[2 * k] = c.a, new_bodies[2 * k + 1] = c.b;
    new_ids[5 * k] = static_cast<uint32_t>(m.count);
    for (int p = 0; p < Manifold::kMost; ++p) {
      new_ids[5 * k + 1 + p] = p < m.count ? m.points[p].id : 0;
      impulse[4 * k + p] = p < m.count ? c.impulse[p] : 0;
      uneven[4 * k + p] = p < m.count ? c.uneven[p] : 0;
    }
    store3(normal.data(), k, m.normal), store3(roll.data(), k, c.roll);
    friction[4 * k] = c.slide.x, friction[4 * k + 1] = c.slide.y, friction[4 * k + 2] = c.slide.z;
    friction[4 * k + 3] = c.twist;
    depth[k] = m.deepest(), offset[k] = c.penetration_offset;
  };
  const auto key = [](uint32_t a, uint32_t b) { return uint64_t{a} << 32 | b; };
  size_t resting_row = 0, k = 0;
  for (const Contact* c : contacts_) {
    while (resting_row < rows_.size() &&
           key(rows_[resting_row].bodies[0], rows_[resting_row].bodies[1]) < key(c->a, c->b))
      put_resting(k++, rows_[resting_row++]);
    put(k++, *c);
  }
  while (resting_row < rows_.size()) put_resting(k++, rows_[resting_row++]);
}

}  // namespace truestep::rigid3d
