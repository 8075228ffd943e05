#include "engine/systems/xpbd/xpbd.h"

#include <algorithm>
#include <cmath>

#include "engine/base/hash.h"
#include "engine/base/text/short_number.h"
#include "engine/systems/xpbd/tearing/division.h"

namespace truestep::xpbd {

using Columns = XpbdColumns;

namespace {

int lanes_of(Precision precision) {
  return precision == Precision::f32 ? Wide<float>::kLanes : Wide<double>::kLanes;
}

/// Height (m) that a body of this size may fall within itself.
double extent(const Body& body) {
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = -low;
  for (const Vec3& x : body.x) {
    low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
  }
  return norm(high - low);
}

double shortest_link(const Body& body) {
  double shortest = HUGE_VAL;
  for (const Link& l : body.links) shortest = std::min(shortest, l.rest);
  return shortest < HUGE_VAL ? shortest : 1;
}

RodSet make_rods(const XpbdDef& def, const Body& body) {
  if (!def.rod) return {};
  const size_t links = static_cast<size_t>(def.rope    ? def.rope->links
                                           : def.helix ? def.helix->links
                                                       : def.hair->links);
  const double link_mass = def.density ? *def.density * body.links.front().rest : def.mass;
  return build_rods(def, body.x, links, link_mass);
}

/// The constraints that are solved one by one. Links of rods are solved together with their frames,
/// simultaneous links by Jacobi; those of matched or elastic bodies are edges only.
Body solved(Body body, const XpbdDef& def) {
  if (def.rod || def.matching || is_elastic(def) || is_membrane(def) || is_simultaneous(def.sweep))
    body.links.clear();
  if (def.matching) body.tetrahedra.clear();
  return body;
}

}  // namespace

Xpbd::Xpbd(const XpbdDef& def, const BuildContext& context)
    : gravity_(context.gravity),
      velocity_(def.velocity),
      wind_(def.wind.value_or(Vec3{})),
      damping_{def.damping, def.internal_damping},
      youngs_(def.youngs_modulus.has_value()),
      elastic_(is_elastic(def)),
      membrane_(is_membrane(def)),
      cosserat_(def.rod.has_value()),
      precision_(def.precision),
      body_(build_body(def, normalized(context.gravity, {0, -1, 0}))),
      rods_(make_rods(def, body_)),
      matches_(def.matching ? build_matches(*def.matching, body_) : MatchSet{}),
      tethers_(def.tether_slack ? build_tethers(body_, *def.tether_slack) : std::vector<Tether>{}),
      attachments_(def.attachments),
      tears_(def.tear ? std::optional<TearSurface>(body_) : std::nullopt),
      schedule_(solved(body_, def),
                def.scheme == Scheme::pbd && def.sweep == Sweep::chains ? Sweep::links : def.sweep,
                lanes_of(def.precision), tears_ ? &*tears_ : nullptr),
      colliders_(build_colliders(def.colliders)) {
  if (def.color) drawing_.color = {def.color->x, def.color->y, def.color->z};
  const Division division = divide(def, context, body_);
  options_ = {
      .scheme = def.scheme,
      .substeps = division.substeps,
      .iterations = def.iterations.value_or(def.scheme == Scheme::pbd || is_simultaneous(def.sweep) ? 20 : 1),
      .sweep = def.sweep,
      .division = division.division,
      .projection = def.projection,
      .radius = 0.5 * def.thickness,
      .shortest_link = shortest_link(body_),
      .self = {.thickness = def.thickness, .friction = def.self_friction}};
  if (def.substeps) longest_substep_ = longest_substep(def, body_);
  if (elastic_) options_.poisson_ratio = def.poisson_ratio.value_or(0.3);
  if (membrane_) options_.membrane = def.membrane, options_.sheet_ratio = def.poisson_ratio.value_or(0.3);
  if (def.self_collision) folds_.emplace(body_);
  if (def.wind) {
    const AirOptions air{0.5 * def.air_density * def.drag_coefficient, def.gust, def.gust_period};
    air_.emplace(body_, air, def.thickness);
  }
  for (const Collider& c : colliders_.colliders()) {
    surfaces_.push_back(c.surface);
    surfaces_.back().restitution = def.restitution;
    if (def.friction) surfaces_.back().friction = *def.friction;
  }
  if (cosserat_) {
    const auto wind = static_cast<State::Column>(def.wind ? 1 : 0);
    rods_.orientation = static_cast<State::Column>(Columns::wind + wind);
    rods_.spin = static_cast<State::Column>(rods_.orientation + 1);
  }
  if (tears_) {
    const auto first = static_cast<State::Column>(Columns::wind + (def.wind ? 1 : 0));
    tears_->columns = {first, first + 1, first + 2};
    tear_limits_ = {def.tear->strain.value_or(HUGE_VAL), def.tear->force.value_or(HUGE_VAL)};
  }
  substep_ = context.dt / options_.substeps;
  step_seconds_ = options_.substeps * substep_seconds(def);
  plan_stages(def, division.why);
  publish();
  show();
  set_remedies({"more substeps", "softer links", "more internal_damping"});
  // What falls, swings or snaps back moves less than its reach in a substep.
  const double reach = 1 + extent(body_);
  double fastest = 0;
  for (const Vec3& v : body_.velocities) fastest = std::max(fastest, norm(v));
  speed_limit_ =
      unexplained_speed(norm(velocity_) + fastest + (1 + def.gust) * norm(wind_) +
                        std::sqrt(2 * norm(gravity_) * reach) + reach * options_.substeps / context.dt);
}

void Xpbd::plan_stages(const XpbdDef& def, const std::string& why) {
  if (cosserat_) {
    skip_stage("links", std::to_string(rods_.rods) + " Cosserat rods of " + std::to_string(rods_.links) +
                            " links are each solved as a whole");
  }
  const size_t bends = body_.rods.size() + body_.hinges.size() + body_.angles.size();
  add_stage("solve",
            std::to_string(options_.substeps) + " substeps of " + std::to_string(options_.iterations) +
                " iterations: " + why + "; " + std::to_string(body_.links.size()) + " links in " +
                std::to_string(schedule_.chains.colours.size()) + " colours" +
                (is_simultaneous(options_.sweep) ? ", all from the same positions"
                 : schedule_.chains.batches.empty() || schedule_.chains.colours.front().longest <= 1
                     ? ", one by one"
                     : ", chain by chain") +
                (colliders_.empty() ? ""
                                    : "; " + std::to_string(colliders_.colliders().size()) +
                                          " colliders keep the points out after every substep") +
                (folds_ ? "; " + std::to_string(folds_->facets().size()) +
                              " facets are kept apart after each substep"
                        : ""),
            [this](State& s, const StepInput& in) {
              const SolverInput what{body_,
                                     schedule_,
                                     options_,
                                     colliders_,
                                     surfaces_,
                                     folds_ ? &*folds_ : nullptr,
                                     air_ ? &*air_ : nullptr,
                                     rods_,
                                     tears_ ? &*tears_ : nullptr,
                                     matches_,
                                     tethers_};
              if (precision_ == Precision::f32) {
                in.workspace.object<Solver<float>>("xpbd.solver").step(what, s, in);
              } else {
                in.workspace.object<Solver<double>>("xpbd.solver").step(what, s, in);
              }
            });
  if (!matches_.empty()) {
    skip_stage("links",
               std::to_string(matches_.groups()) + " bodies are each pulled towards their rest shape");
  }
  if (elastic_) skip_stage("links", "elastic tetrahedra replace them");
  if (membrane_) skip_stage("links", std::to_string(body_.sheet.size()) + " elastic triangles replace them");
  if (tethers_.empty()) skip_stage("tethers", "no tether_slack is given or no point is pinned");
  if (tears_) {
    add_stage("tear",
              "links of " + std::to_string(body_.triangles.size()) + " triangles are checked; at most " +
                  std::to_string(body_.capacity - body_.x.size()) + " points are split off",
              [this](State& s, const StepInput& in) {
                in.workspace.object<Tearing>("xpbd.tearing")
                    .run(*tears_, body_, tear_limits_, s, s.f64(Columns::stiffness));
              });
  }
  add_stage("hands", "ends pushes whose duration is over",
            [](State& s, const StepInput& in) { Columns::kHands.count_down(s, in.h); });
  if (colliders_.empty()) skip_stage("contacts", "there are no colliders");
  if (!air_) skip_stage("air", "no wind is given");
  if (!tears_) skip_stage("tear", "no limits are given");
  if (!folds_) skip_stage("self-collision", "self_collision is off");
  if (bends == 0) skip_stage("bending", "no bending rigidity is given");
  if (const auto crowded = def.mesh ? crowded_edge(*def.mesh) : std::nullopt) {
    skip_stage("bending at crowded edges", crowded->what +
                                               ": cloth is joined there and folds freely; for bending and "
                                               "tearing, split the mesh there and attach the parts");
  }
  if (body_.tetrahedra.empty()) skip_stage("volumes", "there are no tetrahedra");
  if (!(def.damping > 0)) skip_stage("viscous damping", "damping is 0");
  if (!(def.internal_damping > 0)) skip_stage("internal damping", "internal_damping is 0");
}

void Xpbd::publish() {
  if (tears_) return;  // drawn from the state
  for (const Link& l : body_.links) {
    drawing_.lines.push_back({l.a, l.b});
    drawing_.line_kinds.push_back(l.family == Family::shear ? LineKind::shear : LineKind::structural);
  }
  drawing_.triangles = body_.triangles;
  if (!body_.triangles.empty()) return;
  for (const Link& l : body_.links) segments_.push_back({l.a, l.b});
}

State Xpbd::initial_state() const {
  State s;
  const size_t n = body_.x.size();
  s.add({"position", "m", Scalar::f64, 3, Role::position}, n);
  s.add({"velocity", "m/s", Scalar::f64, 3, Role::velocity}, n);
  s.add({"inverse_mass", "1/kg"}, n);
  s.add({"stiffness", "1"}, kFamilies);  // units: see Family
  s.add({"damping", "N s/m"}, 2);
  s.add({"gravity", "m/s^2", Scalar::f64, 3}, 1);
  s.add({"drag.row", "1", Scalar::u32}, 0);
  s.add({"drag.target", "m", Scalar::f64, 3}, 0);
  s.add({"drag.stiffness", "N/m"}, 0);
  s.add({"push.row", "1", Scalar::u32}, 0);
  s.add({"push.force", "N", Scalar::f64, 3}, 0);
  s.add({"push.remaining", "s"}, 0);
  s.add({"tightness", "1/s^2"}, 1);
  if (air_) {
    s.add({"wind", "m/s", Scalar::f64, 3}, 1);
    store3(s.f64(Columns::wind).data(), 0, wind_);
  }
  if (cosserat_) {
    s.add({"orientation", "1", Scalar::f64, 4}, rods_.frames.size());  // w, x, y, z; walls and links
    s.add({"spin", "rad/s", Scalar::f64, 3}, rods_.frames.size());     // in a frame's own axes
    double* q = s.f64(rods_.orientation).data();
    for (const Quat& f : rods_.frames) *q++ = f.w, *q++ = f.x, *q++ = f.y, *q++ = f.z;
  }
  if (tears_) {
    s.add({"mass", "kg"}, n);
    s.add({"origin", "1", Scalar::u32}, n);
    s.add({"corner", "1", Scalar::u32}, 3 * body_.triangles.size());
    std::copy(body_.masses.begin(), body_.masses.end(), s.f64(tears_->columns.mass).begin());
    uint32_t* origin = s.span<uint32_t>(tears_->columns.origin).data();
    for (uint32_t i = 0; i < n; ++i) origin[i] = i;
    uint32_t* corner = s.span<uint32_t>(tears_->columns.corner).data();
    for (const auto& t : body_.triangles) corner = std::copy(t.begin(), t.end(), corner);
    for (const State::Column c :
         {State::Column{Columns::position}, State::Column{Columns::velocity},
          State::Column{Columns::inverse_mass}, tears_->columns.mass, tears_->columns.origin}) {
      s.reserve(c, body_.capacity);
    }
  }
  for (size_t i = 0; i < n; ++i) {
    store3(s.f64(Columns::position).data(), i, body_.x[i]);
    const Vec3 own = body_.velocities.empty() ? Vec3{} : body_.velocities[i];
    store3(s.f64(Columns::velocity).data(), i, velocity_ + own);
    s.f64(Columns::inverse_mass)[i] = 1 / body_.masses[i];
  }
  for (const uint32_t p : body_.pins) {
    s.f64(Columns::inverse_mass)[p] = 0;
    store3(s.f64(Columns::velocity).data(), p, Vec3{});
  }
  std::copy_n(body_.stiffness.data(), kFamilies, s.f64(Columns::stiffness).data());
  std::copy_n(damping_, 2, s.f64(Columns::damping).data());
  store3(s.f64(Columns::gravity).data(), 0, gravity_);
  for (const AttachmentDef& a : attachments_) {
    const auto p = static_cast<uint64_t>(a.point);
    Columns::kHands.set_drag(s, p, a.target.value_or(body_.x[p]), a.stiffness.value_or(default_drag(s, p)),
                             {});
  }
  // Tensions are not known yet: as if the lightest point carried the whole weight on both sides.
  double weight = 0, lightest = HUGE_VAL;
  for (const double m : body_.masses) weight += m * norm(gravity_), lightest = std::min(lightest, m);
  s.f64(Columns::tightness)[0] = 2 * weight / (lightest * options_.shortest_link);
  return s;
}

std::span<const double> Xpbd::masses(const State& s) const {
  return tears_ ? s.f64(tears_->columns.mass) : std::span<const double>(body_.masses);
}

Strand Xpbd::strand(const State& s, size_t link, size_t side) const {
  if (tears_) return tears_->strand(s.span<uint32_t>(tears_->columns.corner), link, side);
  return {body_.links[link].a, body_.links[link].b, 1};
}

void Xpbd::draw(const State& s, double t, Wish wishes, Drawing& out) const {
  out.version = drawing_version(s);
  if (wants(wishes, Wish::constant)) {
    out.parts.resize(parts().size());
    PartDrawing& to = out.parts[0] = drawing_;
    if (tears_) {
      const auto corners = s.span<uint32_t>(tears_->columns.corner);
      for (size_t c = 0; c < corners.size(); c += 3) {
        to.triangles.push_back({corners[c], corners[c + 1], corners[c + 2]});
      }
      for (size_t k = 0; k < body_.links.size(); ++k) {
        for (size_t i = 0; i < strands(k); ++i) {
          const Strand strand = this->strand(s, k, i);
          if (!(strand.share > 0)) continue;
          to.lines.push_back({strand.a, strand.b});
          to.line_kinds.push_back(body_.links[k].family == Family::shear ? LineKind::shear
                                                                         : LineKind::structural);
        }
      }
    }
  }
  if (wants(wishes, Wish::obstacles)) out.obstacles = colliders_.drawn(t);
}

uint32_t Xpbd::drawing_version(const State& s) const {
  if (!tears_ || s.rows(Columns::position) == body_.x.size()) return 1;
  // A cloth may tear elsewhere into as many rows, so the version depends on the corners.
  const auto corners = s.span<uint32_t>(tears_->columns.corner);
  Hasher hash;
  hash.bytes(corners.data(), corners.size_bytes());
  return static_cast<uint32_t>(hash.value() | 2);
}

Ports Xpbd::ports() const {
  return {.points = PointPort{.position = Columns::position,
                              .velocity = Columns::velocity,
                              .mass = std::nullopt,
                              .inverse_mass = Columns::inverse_mass,
                              .id = std::nullopt,
                              .radius = options_.radius},
          .solids = {body_.triangles, segments_},
          .changing = this,
          .pressed = this};
}

std::span<const std::array<uint32_t, 3>> Xpbd::triangles(const State& s) const {
  if (!tears_) return body_.triangles;
  const auto corners = s.span<uint32_t>(tears_->columns.corner);
  return {reinterpret_cast<const std::array<uint32_t, 3>*>(corners.data()), corners.size() / 3};
}

void Xpbd::warn(const State&, double h, std::vector<Warning>& out) const {
  const double needed = std::ceil(h / longest_substep_ * (1 - 1e-9));
  if (!(options_.substeps < needed)) return;
  out.push_back({"few_substeps", static_cast<double>(options_.substeps), needed,
                 "an elastic material of this stiffness and mesh is unstable in fewer than " +
                     short_number(needed) + " substeps a step: give those, or no number (the default holds)",
                 options_.substeps * longest_substep_});
}

void Xpbd::check(StateCheck& check, double) const {
  const size_t points = check.state().rows(Columns::position);
  check.together({Columns::drag_row, Columns::drag_target, Columns::drag_stiffness})
      .together({Columns::push_row, Columns::push_force, Columns::push_remaining});
  for (const auto column : {Columns::drag_row, Columns::push_row}) {
    for (const uint32_t row : check.state().span<uint32_t>(column))
      check.require(row < points, "the row of a push or drag");
  }
  if (!tears_) return;
  const auto& c = tears_->columns;
  check
      .together({Columns::position, Columns::velocity, Columns::inverse_mass, c.mass, c.origin},
                body_.capacity)
      .below(c.corner, points)
      .below(c.origin, body_.x.size())
      .require(points >= body_.x.size(), "the number of points");
  const auto origin = check.state().span<uint32_t>(c.origin), corner = check.state().span<uint32_t>(c.corner);
  for (size_t k = 0; k < corner.size(); ++k) {
    check.require(corner[k] < points && origin[corner[k]] == body_.triangles[k / 3][k % 3],
                  "the point of a triangle's corner");
  }
  for (const double m : check.state().f64(c.mass)) check.require(m > 0, "a mass");
}

std::unique_ptr<const System> build_xpbd(const void* def, const BuildContext& context) {
  return std::make_unique<Xpbd>(*static_cast<const XpbdDef*>(def), context);
}

}  // namespace truestep::xpbd
