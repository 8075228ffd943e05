#include "engine/session/holding.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/text/short_number.h"
#include "engine/geometry/solid.h"

namespace truestep {

namespace {

/// Sizes of a scene that a row falls below all of it before it is lost: what is thrown high, or swings far
/// out, comes back.
constexpr double kSizes = 2;
/// m; half the width of planes and height fields.
constexpr double kWide = 1e9;

Vec3 gravity_of(const Scene& scene, size_t i) {
  const SceneSystem& s = scene.systems[i];
  if (const ParamRow* row = s.row->table->find("gravity")) {
    const ParamValue own = row->get(s.def.get());
    if (const Vec3* g = std::get_if<Vec3>(&own)) return *g;
  }
  return scene.header.gravity;
}

size_t count_of(const Scene& scene, size_t i, const char* name) {
  const ParamRow* row = scene.systems[i].row->table->find(name);
  return row && row->size ? row->size(scene.systems[i].def.get()) : 0;
}

/// Whether a medium is a liquid: snow, sand and jelly may hold what lies in them.
bool flows(const Scene& scene, size_t i) {
  const SceneSystem& s = scene.systems[i];
  const ParamRow* bodies = s.row->table->find("bodies");
  const ParamRow* material = bodies && bodies->nested ? bodies->nested->find("material") : nullptr;
  for (size_t k = 0; material && k < bodies->size(s.def.get()); ++k) {
    const ParamValue value = material->get(bodies->at(s.def.get(), k));
    const auto* word = std::get_if<std::string>(&value);
    if (word && *word != "fluid") return false;
  }
  return true;
}

void add_bodies(const ConstBodies& bodies, Footing& out, bool& falls) {
  for (size_t i = 0; i < bodies.count(); ++i) {
    const BodyForm& form = bodies.form(i);
    const bool fixed = !(form.mass > 0);
    if (fixed && form.solid) out.own = out.stays = true;
    if (!fixed) falls = true;
    const Vec3 at = bodies.place(i);
    Box box{at, at};
    if (form.solid) {
      const SolidKind kind = form.solid->kind;
      const bool wide = kind == SolidKind::plane || kind == SolidKind::height_field;
      box = box.grown(wide ? kWide : bounding_radius(*form.solid));
      // What is wide is a floor, not a scene's size.
      if (wide) box.low = {at.x - kWide, at.y, at.z - kWide}, box.high = {at.x + kWide, at.y, at.z + kWide};
    }
    out.box.cover(box);
  }
}

void add_points(const ConstPoints& points, Footing& out, bool& falls) {
  for (size_t i = 0; i < points.count; ++i) {
    if (points.inverse_mass(i) > 0) {
      falls = true;
    } else {
      out.own = out.stays = true;
    }
    const Vec3 at = points.place(i);
    out.box.cover(at);
  }
}

/// How many rows are further than `depth` along `down`, and the first of them.
template <class Real>
std::pair<size_t, size_t> below(const Real* at, const FieldView& view, const Vec3& down, double depth) {
  const double along[3] = {down.x, down.y, down.z};
  const uint32_t width = std::min(view.width, 3u);
  size_t count = 0, first = 0;
  for (size_t row = 0; row < view.rows; ++row, at += view.width) {
    double sum = 0;
    for (uint32_t c = 0; c < width; ++c) sum += along[c] * static_cast<double>(at[c]);
    if (sum > depth && count++ == 0) first = row;
  }
  return {count, first};
}

/// The size of a box without what is wide.
double size_of(const Box& box) {
  const Vec3 d = box.high - box.low;
  double sum = 0;
  for (const double x : {d.x, d.y, d.z}) {
    if (std::isfinite(x) && x < kWide) sum += x * x;
  }
  return std::sqrt(sum);
}

/// One system, or several of bodies of one kind that nothing couples: each holds what it holds for itself.
/// (Forms of bodies are made for others only.)
bool each_for_itself(const World& world) {
  const auto& systems = world.scene().systems;
  if (systems.size() < 2) return true;
  const auto of_first_kind = [&](const SceneSystem& s) { return s.row == systems.front().row; };
  return world.couplings().empty() && systems.front().row->table->find("bodies") &&
         std::ranges::all_of(systems, of_first_kind);
}

}  // namespace

std::vector<Footing> footings(const World& world, const WorldState& start) {
  std::vector<Footing> out(world.size());
  for (size_t i = 0; i < world.size(); ++i) {
    Footing& f = out[i];
    f.box = Box::nothing();
    const Ports ports = world.system(i).ports();
    bool falls = false;
    if (ports.bodies) {
      Workspace memory;
      add_bodies(ConstBodies(start.systems[i], *ports.bodies), f, falls);
      // Trees of links hang on their base.
      const BodyAccess* access = ports.bodies->access();
      if (access && access->space() != BodyAccess::Space::plane) f.own = f.stays = true, falls = false;
    } else if (ports.points) {
      add_points(ConstPoints(start.systems[i], *ports.points), f, falls);
    }
    if (count_of(world.scene(), i, "colliders") > 0) f.own = f.stays = true;
    if (count_of(world.scene(), i, "joints") > 0) f.own = true;
    if (ports.medium) f.stays = true, falls = false;
    if (falls) f.gravity = gravity_of(world.scene(), i);
  }
  return out;
}

std::vector<Issue> scene_doubts(const World& world, const WorldState& start) {
  std::vector<Issue> out;
  const Scene& scene = world.scene();
  for (size_t k = 0; k < scene.couplings.size(); ++k) {
    for (std::string& doubt : world.couplings()[k]->doubts())
      out.push_back({"/couplings/" + std::to_string(scene.couplings[k].place), "doubtful", std::move(doubt),
                     "", "", "", ""});
  }
  if (each_for_itself(world)) return out;
  const std::vector<Footing> all = footings(world, start);
  for (size_t i = 0; i < all.size(); ++i) {
    const Footing& f = all[i];
    const double g = norm(f.gravity);
    if (!(g > 0) || f.own) continue;
    const std::string id = '"' + world.id(i) + '"';
    bool joined = false;
    for (const SceneCoupling& c : scene.couplings) {
      if (c.a != i && c.b != i) continue;
      joined = true;
      const size_t other = c.a == i ? c.b : c.a;
      if (!world.system(other).ports().medium || !flows(scene, other)) continue;
      const bool only = std::ranges::none_of(
          scene.couplings, [&](const SceneCoupling& k) { return &k != &c && (k.a == i || k.b == i); });
      if (!only) continue;
      out.push_back({"/couplings/" + std::to_string(c.place), "unheld",
                     "nothing in this scene holds " + id + " where they leave \"" + world.id(other) +
                         "\": its walls hold the medium only",
                     "", "fixed bodies in " + id + " for the floor and the walls", "", ""});
    }
    if (joined) continue;
    const Vec3 down = f.gravity / g;
    const auto under = [&](size_t j) {
      if (j == i || !all[j].stays) return false;
      // Beside each other they would never meet.
      Box below = f.box;
      below.cover(below.low + down * kWide), below.cover(below.high + down * kWide);
      return below.overlaps(all[j].box) || world.system(j).ports().medium;
    };
    for (size_t j = 0; j < all.size(); ++j) {
      if (!under(j)) continue;
      out.push_back(
          {"/systems/" + std::to_string(scene.systems[i].place), "unheld",
           "nothing in this scene holds " + id + ": no coupling lets it meet \"" + world.id(j) + '"', "",
           "a coupling of the two, contact for example", "", ""});
      break;
    }
  }
  return out;
}

FallWatch::FallWatch(const World& world, const WorldState& start) {
  if (each_for_itself(world)) return;
  const std::vector<Footing> all = footings(world, start);
  const auto falls = [](const Footing& f) { return norm2(f.gravity) > 0; };
  if (std::ranges::none_of(all, falls)) return;
  const bool anything = !world.couplings().empty() || std::ranges::any_of(all, &Footing::stays);
  if (!anything) return;
  Box scene = Box::nothing();
  std::vector<double> scratch;
  for (const PartTable::Entry& part : world.parts()) {
    if (part.info().kind != PartInfo::Kind::points) continue;
    const FieldView view = part.field(start.systems[part.system], 0, scratch);
    for (size_t row = 0; row < view.rows; ++row) {
      Vec3 at;
      at.x = element(view, row * view.width), at.y = view.width > 1 ? element(view, row * view.width + 1) : 0;
      at.z = view.width > 2 ? element(view, row * view.width + 2) : 0;
      scene.cover(at);
    }
  }
  if (!scene.finite()) return;
  const double size = size_of(scene);
  if (!(size > 0)) return;
  for (size_t p = 0; p < world.parts().size(); ++p) {
    const PartTable::Entry& part = world.parts()[p];
    if (part.index != 0 || part.info().kind != PartInfo::Kind::points || !falls(all[part.system])) continue;
    const Vec3 down = normalized(all[part.system].gravity);
    double lowest = -std::numeric_limits<double>::infinity();
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 at{corner & 1 ? scene.high.x : scene.low.x, corner & 2 ? scene.high.y : scene.low.y,
                    corner & 4 ? scene.high.z : scene.low.z};
      lowest = std::max(lowest, dot(at, down));
    }
    watched_.push_back({part.system, p, down, lowest + kSizes * size, short_number(kSizes * size)});
  }
}

void FallWatch::warn(const World& world, const WorldState& state,
                     std::vector<World::SystemWarning>& out) const {
  for (const Watched& w : watched_) {
    const PartTable::Entry& part = world.parts()[w.part];
    const FieldView view = part.field(state.systems[w.system], 0, scratch_);
    if (view.type != Scalar::f64 && view.type != Scalar::f32) continue;
    const auto [lost, first] = view.type == Scalar::f64
                                   ? below(static_cast<const double*>(view.data), view, w.down, w.lost)
                                   : below(static_cast<const float*>(view.data), view, w.down, w.lost);
    if (lost == 0) continue;
    const std::string rows = lost == 1
                                 ? "row " + std::to_string(first) + " has"
                                 : std::to_string(lost) + " of " + std::to_string(view.rows) + " rows have";
    out.push_back({w.system,
                   {"fallen", static_cast<double>(lost), 0,
                    rows + " fallen more than " + w.why +
                        " m, twice the scene's size, below all that was there at the start: nothing holds it",
                    0}});
  }
}

}  // namespace truestep
