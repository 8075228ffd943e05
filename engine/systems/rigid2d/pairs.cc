#include "engine/systems/rigid2d/pairs.h"

#include <algorithm>
#include <cmath>

#include "engine/base/random.h"
#include "engine/rigid/one_way.h"
#include "engine/rigid/toi_clamp.h"
#include "engine/systems/rigid2d/solver/meetings.h"
#include "engine/systems/rigid2d/solver/seams.h"

namespace truestep::rigid2d {
namespace {

constexpr size_t kBlock = 512;
constexpr double kFat =
    0.15;  // fraction of a body's size that it may move before the broad phase sorts it in again

bool moves(const double* v, double w) {
  return v[0] != 0 || v[1] != 0 || w != 0;
}

/// Contacts are speculative for as far as a body moves in a step, but not for more than half its thickness: a
/// contact plane extends beyond the surface that it stands for.
Vec2 foreseen(Vec2 shift, double inner) {
  const double length = flat::norm(shift), most = 0.5 * inner;
  return length > most ? (most / length) * shift : shift;
}
void stretch(Box& b, Vec2 ahead) {
  (ahead.x < 0 ? b.low.x : b.high.x) += ahead.x;
  (ahead.y < 0 ? b.low.y : b.high.y) += ahead.y;
}

void place(const Model& model, const State& s, double h, Pairs& p, const ThreadArena& arena) {
  const size_t n = model.count();
  const auto status = s.span<uint32_t>(columns::status);
  p.pose.resize(n + 1), p.ahead.resize(n + 1), p.active.assign(n + 1, 0);
  const double* v = s.f64(columns::velocity).data();
  const auto w = s.f64(columns::angular_velocity);
  arena.for_blocks(n, kBlock, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      p.pose[i] = pose_of(s, i);
      p.ahead[i] = foreseen({h * v[3 * i], h * v[3 * i + 1]}, model.light[i].inner);
      const Light& b = model.light[i];
      const bool moved = is_moved(b, status[i]) ||
                         (b.motion == Motion::kinematic && status[i] == kAwake && moves(v + 3 * i, w[i]));
      const double way = h * (flat::norm(Vec2{v[3 * i], v[3 * i + 1]}) + std::abs(w[i]) * b.reach);
      p.active[i] = !moved ? kStill : may_pass_through(way, model.thinnest) ? kMovesFar : kMoves;
    }
  });
  p.pose[n] = {}, p.ahead[n] = {};
  p.boxes.resize(model.shapes.size()), p.mobility.resize(model.shapes.size());
  arena.for_blocks(model.shapes.size(), kBlock, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const uint32_t body = model.body_of[i];
      const Light& owner = model.light[body];
      // Shapes that collide with nothing are left out.
      const bool gone = (status[body] & kRemoved) || owner.sensor || (owner.mask == 0 && owner.group <= 0);
      p.mobility[i] = owner.motion == Motion::dynamic ? Mobility::moving : Mobility::fixed;
      p.boxes[i] = gone ? Box::nothing()
                        : flat::bounds(model.shapes[i].outline, p.pose[body]).grown(0.5 * model.margin);
      if (!gone) stretch(p.boxes[i], p.ahead[body]);
    }
  });
}

/// Matches candidates with the contacts they continue; both lists ascend.
void match(const Model& model, const State& s, Pairs& p, std::span<const BodyPair> found) {
  const auto keys = s.span<uint64_t>(columns::contact_key);
  p.hits.resize(found.size());
  size_t old = 0, count = 0;
  for (const BodyPair& pair : found) {
    const uint32_t a = model.body_of[pair.a], b = model.body_of[pair.b];
    if (!may_touch(model, a, b)) continue;
    Hit& h = p.hits[count++];
    h.a = pair.a, h.b = pair.b, h.body_a = a, h.body_b = b;
    h.what = Hit::What::untested, h.old = kNoPoint;
    const uint64_t key = h.key();
    while (old < keys.size() && keys[old] < key) ++old;
    if (old < keys.size() && keys[old] == key) h.old = static_cast<uint32_t>(old);
  }
  p.hits.resize(count);
  if (p.contacts.size() < count) p.contacts.resize(count);
}

/// Pose of b in the frame of a for the narrow phase, `apart2` m^2 from it. Shapes at exactly one place have
/// no direction to separate in: they are taken a millionth of their size apart, in a direction of the pair's
/// own. With one direction for all, many bodies would form a line that hardly separates.
Pose seen_apart(const Hit& h, Pose b_in_a, double apart2, double size) {
  if (apart2 > 1e-24 * size * size) return b_in_a;
  const auto u = uniform4(0, h.a, h.b);
  const Vec2 aside = flat::unit(Vec2{u[0] - 0.5, u[1] - 0.5});
  b_in_a.p = b_in_a.p + 1e-6 * size * aside;
  return b_in_a;
}

void touch_pair(const Model& model, const State& s, const Pairs& p, Hit& h, flat::Contact& contact) {
  const Pose &a = p.pose[h.body_a], &b = p.pose[h.body_b];
  const double margin = model.margin + flat::norm(p.ahead[h.body_b] - p.ahead[h.body_a]);
  const flat::Outline &of_a = model.shapes[h.a].outline, &of_b = model.shapes[h.b].outline;
  const Pose b_in_a = a.to(b);
  const Vec2 between = b_in_a * of_b.center - of_a.center;
  const Pose seen = seen_apart(h, b_in_a, flat::dot(between, between), model.light[h.body_b].inner);
  if (!flat::touch(of_a, of_b, seen, margin, contact)) return;
  contact.normal = a.q * contact.normal;
  for (uint32_t k = 0; k < contact.points; ++k) contact.point[k].at = a.q * contact.point[k].at;
  if (!passes_one_way(model, s, h, contact)) h.what = Hit::What::touching;
}

/// Whether a hit wakes the body that sleeps. Bodies just farther apart than the margin fall asleep
/// separately; if the slightest approach were enough, they would wake one another for ever.
bool wakes(const Model& model, const Pairs& p, size_t i) {
  const Hit& h = p.hits[i];
  const flat::Contact& contact = p.contacts[i];
  double gap = HUGE_VAL;
  for (uint32_t k = 0; k < contact.points; ++k) gap = std::min(gap, contact.point[k].separation);
  return gap <= 0.5 * model.margin + flat::norm(p.ahead[h.body_b] - p.ahead[h.body_a]);
}

}  // namespace

/// True where the contact passes a one-way platform: it holds a body that comes from outside and moves
/// towards it, and keeps holding that body.
bool passes_one_way(const Model& model, const State& s, const Hit& h, const flat::Contact& contact) {
  if (!(model.light[h.body_a].one_way || model.light[h.body_b].one_way) || h.old != kNoPoint) return false;
  const Body &a = model.bodies[h.body_a], &b = model.bodies[h.body_b];
  const auto through = [&](const Body& platform, uint32_t at, uint32_t other, Vec2 n, const Pose& pose) {
    const Vec2 up = pose.q * platform.one_way_direction;
    const double* v = s.f64(columns::velocity).data();
    const Vec2 relative{v[3 * other] - v[3 * at], v[3 * other + 1] - v[3 * at + 1]};
    double deepest = 0;
    for (uint32_t k = 0; k < contact.points; ++k) deepest = std::min(deepest, contact.point[k].separation);
    return !one_way_holds(flat::dot(n, up), flat::dot(relative, up)) || deepest < -model.margin;
  };
  if (a.one_way && through(a, h.body_a, h.body_b, contact.normal, pose_of(s, h.body_a))) return true;
  return b.one_way && through(b, h.body_b, h.body_a, -contact.normal, pose_of(s, h.body_b));
}

bool may_touch(const Model& model, uint32_t body_a, uint32_t body_b) {
  if (body_a == body_b) return false;
  const Light &a = model.light[body_a], &b = model.light[body_b];
  if (a.motion != Motion::dynamic && b.motion != Motion::dynamic) return false;
  if (a.group != 0 && a.group == b.group) {
    if (a.group < 0) return false;
  } else if (!(a.mask & b.category) || !(b.mask & a.category)) {
    return false;
  }
  if (model.not_touching.empty()) return true;
  const uint64_t key = uint64_t{std::min(body_a, body_b)} << 32 | std::max(body_a, body_b);
  return !std::binary_search(model.not_touching.begin(), model.not_touching.end(), key);
}

void find_contacts(const Model& model, State& s, double h, Pairs& p, const ThreadArena& arena) {
  place(model, s, h, p, arena);
  match(model, s, p, p.broad.update(p.boxes, p.mobility, kFat * model.size));
  const size_t n = model.count();
  std::vector<uint8_t>& seeds = p.seeds;
  seeds.assign(n, 0);
  p.met.clear();
  bool looked = std::find(p.active.begin(), p.active.end(), kMovesFar) == p.active.end();
  // A body that is touched wakes together with its island, and may touch others in turn.
  for (;;) {
    arena.for_blocks(p.hits.size(), kBlock, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        Hit& h = p.hits[i];
        if (h.what != Hit::What::untested || !(p.active[h.body_a] || p.active[h.body_b])) continue;
        h.what = Hit::What::none;
        touch_pair(model, s, p, h, p.contacts[i]);
      }
    });
    bool any = !looked && find_meetings(model, s, h, p);
    looked = true;
    const auto status = s.span<uint32_t>(columns::status);
    for (size_t i = 0; i < p.hits.size(); ++i) {
      const Hit& h = p.hits[i];
      if (h.what != Hit::What::touching || (p.active[h.body_a] && p.active[h.body_b])) continue;
      const uint32_t still = p.active[h.body_a] ? h.body_b : h.body_a;
      if (!is_asleep(model.light[still], status[still]) || !wakes(model, p, i)) continue;
      seeds[still] = 1, any = true;
    }
    if (!any || !wake_islands(model, s, seeds)) break;
    for (size_t i = 0; i < n; ++i) {
      if (is_moved(model.light[i], status[i])) p.active[i] = 1;
    }
  }
  if (model.seams) leave_out_seams(model, p);
  p.touching.clear();
  for (size_t i = 0; i < p.hits.size(); ++i) {
    Hit& h = p.hits[i];
    if (h.what == Hit::What::touching) {
      p.touching.push_back(static_cast<uint32_t>(i));
    } else if (h.what == Hit::What::untested && h.old != kNoPoint) {
      h.what = Hit::What::carried;
    }
  }
}

}  // namespace truestep::rigid2d
