// A step of the fluid: substeps as short as its fastest particle requires, each sorting the rows anew.
// Compiled once for each dimension and precision (solver_plane.cc, solver_space.cc).
#pragma once
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "engine/base/errors.h"
#include "engine/base/text/short_number.h"
#include "engine/systems/sph/neighbours.h"
#include "engine/systems/sph/solvers/allowed.h"
#include "engine/systems/sph/solvers/dfsph.h"
#include "engine/systems/sph/solvers/divergence.h"
#include "engine/systems/sph/solvers/pbf.h"
#include "engine/systems/sph/solvers/read_pressures.h"
#include "engine/systems/sph/solvers/shifting.h"
#include "engine/systems/sph/solvers/tension.h"
#include "engine/systems/sph/solvers/viscosity.h"
#include "engine/systems/sph/solvers/vorticity.h"
#include "engine/systems/sph/solvers/wcsph.h"
#include "engine/systems/sph/speeds.h"
#include "engine/systems/sph/walls.h"

namespace truestep::sph {

template <int D, class T>
class SolverOf final : public Solver {
 public:
  explicit SolverOf(const Setting& setting)
      : set_(setting),
        allowed_(setting),
        neighbours_(setting),
        walls_(setting),
        dfsph_(setting),
        wcsph_(setting),
        pbf_(setting, neighbours_, walls_),
        shifting_(setting),
        viscosity_(setting, walls_) {
    const SphDef& d = setting.def;
    implicit_ = d.solves_viscosity();
    viscous_ = d.viscosity > 0 && !implicit_;
  }

  void step(State& s, const StepInput& in) const override {
    auto& f = in.workspace.object<Fluid<D, T>>("sph.fluid");
    f.unit = neighbours_.unit();
    f.weighted = set_.lightest < 1 || set_.ratio || !set_.inlets.empty();
    f.renews = set_.def.solver == Method::pbf;
    if (set_.counts)
      f.reserve(set_.capacity, expected_neighbours(set_.def), static_cast<size_t>(neighbours_.extras()));
    auto& bodies = in.workspace.object<BodiesIn<D, T>>("sph.bodies");
    bodies.set(in.bodies, set_);
    const Vec3 gravity = load3(std::as_const(s).f64(columns::gravity).data(), 0);
    Tracks tracks;
    double left = in.h;
    for (int64_t k = 0; left > 0; ++k) {
      f.resize(s.rows(columns::position));
      const double walls = fastest_wall(set_.def, set_.colliders, set_.meshes, in.t + in.h - left, left);
      const auto [allowed, flow, crossed] =
          allowed_(s, f, std::max(bodies.fastest(), walls), gravity, in.arena);
      const double parts = std::ceil(left / allowed);
      if (!(parts + static_cast<double>(k) <= set_.def.max_substeps)) refuse(allowed);
      const double h = parts > 1 ? left / parts : left;
      // Where viscosity alone divides a step, the flow hardly moves in a substep.
      const double part = in.h > allowed && flow > allowed ? std::max(h / flow, kLeastPart) : 1;
      const double tolerance = part < 1 ? 1 : std::clamp(kHurried * crossed, kCalm, 1.0);
      substep(s, f, bodies, gravity, in,
              {.t = in.t + in.h - left, .h = h, .part = part, .tolerance = tolerance}, tracks);
      tracks.courant = std::max(tracks.courant, h / allowed * set_.def.courant);
      ++tracks.substeps;
      left = h < left ? left - h : 0;
    }
    const auto r = s.f64(columns::report);
    r[report::mean_error] = tracks.mean, r[report::max_error] = tracks.most;
    r[report::substeps] = tracks.substeps, r[report::courant] = tracks.courant;
    r[report::density_iterations] = tracks.density / tracks.substeps;
    r[report::flow_iterations] = tracks.flow / tracks.substeps;
    if (implicit_) r[report::viscous_iterations] = tracks.viscous / tracks.substeps;
  }

  void read_pressures(const State& s, std::vector<double>& out) const override {
    const ThreadArena alone;
    Fluid<D, T> f = listed(s, alone);
    out.resize(f.n);
    sph::read_pressures(set_, f, s, alone, out.data());
  }

  double read_divergence(const State& s) const override {
    const ThreadArena alone;
    Fluid<D, T> f = listed(s, alone);
    return largest_divergence(f, s.span<T>(columns::velocity).data(), alone);
  }

 private:
  /// The positions of a state with their neighbour lists.
  Fluid<D, T> listed(const State& s, const ThreadArena& alone) const {
    Fluid<D, T> f;
    f.unit = neighbours_.unit(), f.resize(s.rows(columns::position));
    neighbours_.sort(f, s.span<T>(columns::position).data(), alone);
    neighbours_.list(f, alone);
    return f;
  }

  struct Substep {
    double t, h, part, tolerance;  ///< s, start and length; 1, of the time in which the flow moves as far as
                                   ///< it may; 1, of the density error that solves may leave
  };
  struct Tracks {
    double mean = 0, most = 0, substeps = 0, density = 0, flow = 0, viscous = 0, courant = 0;
  };

  void substep(State& s, Fluid<D, T>& f, BodiesIn<D, T>& bodies, const Vec3& gravity, const StepInput& in,
               const Substep& now, Tracks& tracks) const {
    const double t = now.t, h = now.h, end = t + h;
    const SphDef& d = set_.def;
    const bool places = d.solver == Method::pbf;
    if (places) {
      fall(s, gravity, now, in.arena);
      bodies.pull(f, gravity, h), bodies.advance(h);
    }
    {
      const ProfileScope scope(in.profile, "sph neighbours");
      neighbours_.sort(f, s.span<T>(columns::position).data(), in.arena);
      walls_.shares(f, places ? end : t, in.arena);
      if (bodies.any()) bodies.touch(f, in.arena);
      if (f.weighted) weigh(s, f, t, in.arena);
      neighbours_.list(f, in.arena);
      load(s, f, norm(gravity), in.arena);
    }
    const ProfileScope scope(in.profile, "sph pressure");
    if (places) {
      pbf_.correct(f, bodies, end, h, in.arena);
      tracks.density += d.pbf_iterations;
    }
    forces(f, places ? Vec3{} : gravity, t, static_cast<T>(h), in.arena);
    if (implicit_) tracks.viscous += viscosity_.solve(f, t, h, in.arena);
    if (!places) bodies.lean(f, gravity, h), bodies.pull(f, gravity, h);
    if (viscous_ && d.walls == Walls::no_slip) bodies.hold(f, h);
    if (d.solver == Method::wcsph) wcsph_.advance(f, bodies, gravity, h, in.arena);
    if (d.solver == Method::dfsph) {
      // Substeps that a load shortens must not separate an initial overlap as much faster.
      const double g = norm(gravity), longest = g > 0 ? allowed_.by_fall(g) : h;
      const double share = set_.ratio && t < kSettling * longest ? std::min(h / longest, 1.0) : 1;
      const auto [flow, push] = dfsph_.solve(
          f, bodies, {.h = h, .share = share, .part = now.part, .tolerance = now.tolerance}, in.arena);
      tracks.flow += flow.iterations, tracks.density += push.iterations;
    }
    const bool both = d.solver == Method::wcsph;
    const auto error = f.tally(in.arena, [&](size_t i) {
      const double e = double{f.delta[i]} - 1;
      return std::array<double, 3>{both ? std::abs(e) : std::max(e, 0.0), 0, 0};
    });
    tracks.mean = error.sum / std::max(static_cast<double>(f.n), 1.0), tracks.most = error.most;
    if (shifting_.any()) {
      const ProfileScope shifts(in.profile, "sph shifting");
      shifting_.shift(f, fastest(f, in.arena) * h, both, in.arena);
    }
    move(s, f, end, static_cast<T>(h), in.arena);
    if (!places) bodies.advance(h);
    if (!set_.inlets.empty()) pour(set_, s, end, in.workspace);
  }

  /// m/s, of any particle.
  double fastest(Fluid<D, T>& f, const ThreadArena& arena) const {
    const auto squares = f.tally(arena, [&](size_t i) {
      const T* v = f.v.data() + 4 * i;
      return std::array<double, 3>{double{v[0] * v[0] + v[1] * v[1] + v[2] * v[2]}, 0, 0};
    });
    return std::sqrt(squares.most);
  }

  /// Gravity, viscosity, surface tension.
  void forces(Fluid<D, T>& f, const Vec3& gravity, double t, T h, const ThreadArena& arena) const {
    const T g[3] = {static_cast<T>(gravity.x), static_cast<T>(gravity.y), static_cast<T>(gravity.z)};
    const SphDef& d = set_.def;
    const bool leans = norm2(gravity) > 0;
    const bool holds = viscous_ && d.walls == Walls::no_slip;
    const T viscosity = static_cast<T>(viscous_ ? 2 * d.viscosity : 0), blend = static_cast<T>(60 * d.xsph);
    const bool blends = viscosity > 0 || blend > 0;
    if (blends) blend_velocities(f, -viscosity, blend, arena);
    const auto accelerate = [&](size_t i) {
      T* out = f.a.data() + 4 * i;
      const T* v = f.v.data() + 4 * i;
      for (size_t a = 0; a < D; ++a) out[a] = blends ? g[a] + out[a] : g[a];
      for (size_t a = D; a < 4; ++a) out[a] = 0;
      if (leans && f.wall[4 * i + 3] > 0 && f.rests[i] > 0) {
        const double x[3] = {double{f.x[0][i]}, double{f.x[1][i]}, D == 3 ? double{f.x[2][i]} : 0};
        const double share = double{f.wall[4 * i + 3]};
        const Vec3 lean = (walls_.lean(x, gravity, share, t) - gravity * share) * double{f.rests[i]};
        out[0] += static_cast<T>(lean.x), out[1] += static_cast<T>(lean.y);
        if constexpr (D == 3) out[2] += static_cast<T>(lean.z);
      }
      if (holds && f.wall[4 * i + 3] > 0) {
        const double x[3] = {double{f.x[0][i]}, double{f.x[1][i]}, D == 3 ? double{f.x[2][i]} : 0};
        const Vec3 drag = walls_.drag(x, {double{v[0]}, double{v[1]}, double{v[2]}}, t);
        out[0] += static_cast<T>(drag.x), out[1] += static_cast<T>(drag.y);
        if constexpr (D == 3) out[2] += static_cast<T>(drag.z);
      }
    };
    arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) accelerate(i);
    });
    if (d.surface_tension > 0) {
      const T strength = static_cast<T>(set_.cohesion), support = static_cast<T>(set_.support);
      if (d.surface_tension_model == Tension::cohesion) draw_together(f, strength, support, arena);
      if (d.surface_tension_model == Tension::interface) {
        shrink_interface(f, strength, *set_.interface, support, arena);
      }
    }
    kick(f, h, arena);
    if (d.vorticity > 0) {
      confine_vorticity(f, static_cast<T>(d.vorticity), static_cast<T>(d.spacing), h, arena);
    }
    if (!set_.inlets.empty()) keep_held(f, arena);
  }

  /// Sets how light particles are, and which are in a nozzle.
  void weigh(const State& s, Fluid<D, T>& f, double t, const ThreadArena& arena) const {
    const T* ratio = set_.ratio ? s.span<T>(set_.ratio).data() : nullptr;
    arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        f.held[k] = nozzle_at({double{f.x[0][k]}, double{f.x[1][k]}, D == 3 ? double{f.x[2][k]} : 0}, t);
        f.light[k] = f.held[k] ? T{0} : ratio ? 1 / ratio[f.row(k)] : T{1};
      }
    });
  }
  /// The nozzle that holds a particle at x, from 1; 0: none.
  uint8_t nozzle_at(const Vec3& x, double t) const {
    for (size_t k = 0; k < set_.inlets.size(); ++k) {
      if (set_.inlets[k].holds(x, t)) return static_cast<uint8_t>(k + 1);
    }
    return 0;
  }
  /// Sets the velocities of particles held by nozzles.
  void keep_held(Fluid<D, T>& f, const ThreadArena& arena) const {
    arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        if (!f.held[k]) continue;
        const Vec3 u = set_.inlets[f.held[k] - 1u].velocity();
        f.v[4 * k] = static_cast<T>(u.x), f.v[4 * k + 1] = static_cast<T>(u.y);
        if (D == 3) f.v[4 * k + 2] = static_cast<T>(u.z);
      }
    });
  }

  /// Velocities and positions after a substep under gravity alone.
  void fall(State& s, const Vec3& gravity, const Substep& now, const ThreadArena& arena) const {
    const T h = static_cast<T>(now.h);
    T *x = s.span<T>(columns::position).data(), *v = s.span<T>(columns::velocity).data();
    const T g[3] = {static_cast<T>(gravity.x), static_cast<T>(gravity.y), static_cast<T>(gravity.z)};
    arena.for_blocks(s.rows(columns::position), kBlockRows, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        T unused[3] = {}, place[3] = {};
        const bool free = set_.inlets.empty() ||
                          !nozzle_at({double{x[3 * i]}, double{x[3 * i + 1]}, double{x[3 * i + 2]}}, now.t);
        for (size_t a = 0; a < D; ++a)
          place[a] = x[3 * i + a] + h * (v[3 * i + a] + (free ? h * g[a] : T{0}));
        walls_.keep_inside(place, unused, now.t + now.h);
        for (size_t a = 0; a < D; ++a) v[3 * i + a] = (place[a] - x[3 * i + a]) / h;
        walls_.wrap(place);
        for (size_t a = 0; a < D; ++a) x[3 * i + a] = place[a];
      }
    });
  }

  /// `weight` is the magnitude of gravity. Particles count as at rest where their pressure is at least that
  /// of one spacing's depth.
  void load(const State& s, Fluid<D, T>& f, double weight, const ThreadArena& arena) const {
    const T *v = s.span<T>(columns::velocity).data(), *push = s.span<T>(columns::push).data(),
            *flow = s.span<T>(columns::flow).data(), *density = s.span<T>(columns::density).data();
    const bool carried = set_.def.solver == Method::wcsph, shifts = shifting_.any();
    if (shifts) f.inside.resize(f.n);
    const T sound = static_cast<T>(set_.sound), per_layer = static_cast<T>(1 / (set_.def.spacing * weight));
    arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        const size_t i = f.row(k);
        for (size_t a = 0; a < 3; ++a) f.v[4 * k + a] = v[3 * i + a];
        f.v[4 * k + 3] = 0;
        f.push[k] = push[i], f.flow[k] = flow[i];
        if (shifts) f.inside[k] = Shifting<D, T>::inside(f.delta[k]);
        if (carried) f.delta[k] = density[i];
        const T under = carried ? tait(f.delta[k], sound) : f.push[k] + f.flow[k];
        const T layers = f.weighted ? under * per_layer * f.light[k] : under * per_layer;
        f.rests[k] = weight > 0 ? std::min(std::max(layers, T{0}), T{1}) : T{0};
      }
    });
  }

  /// Positions after h s at the current velocities; writes all rows back to the state.
  void move(State& s, const Fluid<D, T>& f, double t, T h, const ThreadArena& arena) const {
    T *x = s.span<T>(columns::position).data(), *v = s.span<T>(columns::velocity).data(),
      *push = s.span<T>(columns::push).data(), *flow = s.span<T>(columns::flow).data(),
      *density = s.span<T>(columns::density).data(), *pressure = s.span<T>(columns::pressure).data();
    const bool carried = set_.def.solver == Method::wcsph, solved = set_.def.solver == Method::dfsph;
    const bool shifts = shifting_.any();
    const T on = set_.def.solver == Method::pbf ? T{0} : h;
    const T rest = static_cast<T>(set_.def.density), sound = static_cast<T>(set_.sound);
    arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        const size_t i = f.row(k);
        T place[3] = {}, speed[3] = {};
        for (size_t a = 0; a < D; ++a) speed[a] = f.v[4 * k + a], place[a] = f.x[a][k] + on * speed[a];
        for (size_t a = 0; shifts && a < D; ++a) place[a] += f.shift[4 * k + a];
        walls_.keep_off(place, speed, t);
        for (size_t a = 0; a < D; ++a) x[3 * i + a] = place[a], v[3 * i + a] = speed[a];
        const T d = f.delta[k];
        density[i] = d;
        pressure[i] = carried  ? rest * tait(d, sound)
                      : solved ? rest * d * d * (f.push[k] + f.flow[k])
                               : rest * d * d * f.flow[k] / (h * h);
        push[i] = solved ? f.push[k] : T{0}, flow[i] = solved ? f.flow[k] : T{0};
      }
    });
  }

  [[noreturn]] void refuse(double allowed) const {
    Instability failure(set_.id, "velocity", -1,
                        "the fluid's particles allow substeps of " + short_number(allowed, 3) +
                            " s, more than max_substeps (" + std::to_string(set_.def.max_substeps) +
                            ") a step");
    if (allowed > 0) failure.suggested_dt = allowed * set_.def.max_substeps;
    throw failure;
  }

  /// Where the fastest crosses less than a tenth of what it may, solves leave less of an error, down to a
  /// tenth: what they leave would keep a pool shaking at 2 % of sqrt(g H).
  static constexpr double kHurried = 10, kCalm = 0.1;
  static constexpr double kLeastPart = 1e-4;  ///< of a flow that does not move
  static constexpr double kSettling = 20;     ///< longest substeps, in which an initial overlap separates

  const Setting& set_;
  Allowed<D, T> allowed_;
  Neighbours<D, T> neighbours_;
  BoxWalls<D, T> walls_;
  Dfsph<D, T> dfsph_;
  Wcsph<D, T> wcsph_;
  Pbf<D, T> pbf_;
  Shifting<D, T> shifting_;
  ImplicitViscosity<D, T> viscosity_;
  bool viscous_ = false;   ///< explicit viscosity, by short enough substeps
  bool implicit_ = false;  ///< by a solve
};

}  // namespace truestep::sph
