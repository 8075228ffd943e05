// A step of the fluid: substeps as short as its fastest particle requires, each sorting the rows anew.
#include <cmath>
#include <string>

#include "engine/base/errors.h"
#include "engine/base/text/short_number.h"
#include "engine/systems/sph/neighbours.h"
#include "engine/systems/sph/solvers/dfsph.h"
#include "engine/systems/sph/solvers/divergence.h"
#include "engine/systems/sph/solvers/layer_load.h"
#include "engine/systems/sph/solvers/pbf.h"
#include "engine/systems/sph/solvers/read_pressures.h"
#include "engine/systems/sph/solvers/tension.h"
#include "engine/systems/sph/solvers/viscosity.h"
#include "engine/systems/sph/solvers/vorticity.h"
#include "engine/systems/sph/solvers/wcsph.h"
#include "engine/systems/sph/speeds.h"
#include "engine/systems/sph/walls.h"

namespace truestep::sph {

namespace {

template <int D, class T>
class SolverOf final : public Solver {
 public:
  explicit SolverOf(const Setting& setting)
      : set_(setting),
        neighbours_(setting),
        walls_(setting),
        dfsph_(setting),
        wcsph_(setting),
        pbf_(setting, neighbours_, walls_),
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
      const double allowed = limit(s, f, std::max(bodies.fastest(), walls), gravity, in.arena);
      const double parts = std::ceil(left / allowed);
      if (!(parts + static_cast<double>(k) <= set_.def.max_substeps)) refuse(allowed);
      const double h = parts > 1 ? left / parts : left;
      substep(s, f, bodies, gravity, in, in.t + in.h - left, h, tracks);
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
  /// The places of a state with the lists of their neighbours.
  Fluid<D, T> listed(const State& s, const ThreadArena& alone) const {
    Fluid<D, T> f;
    f.unit = neighbours_.unit(), f.resize(s.rows(columns::position));
    neighbours_.sort(f, s.span<T>(columns::position).data(), alone);
    neighbours_.list(f, alone);
    return f;
  }

  struct Tracks {
    double mean = 0, most = 0, substeps = 0, density = 0, flow = 0, viscous = 0, courant = 0;
  };

  /// s, allowed by the fastest particle, body or wall (`solids`, m/s), sound and viscosity.
  double limit(const State& s, Fluid<D, T>& f, double solids, const Vec3& gravity,
               const ThreadArena& arena) const {
    const auto v = s.span<T>(columns::velocity);
    const SphDef& d = set_.def;
    f.partial.assign((f.n + kBlockRows - 1) / kBlockRows, 0);
    arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
      double most = 0;
      for (size_t k = begin; k < end; ++k) {
        double square = 0;
        for (size_t a = 0; a < D; ++a) square += double{v[3 * k + a]} * double{v[3 * k + a]};
        if (!(square <= most)) most = square;
      }
      f.partial[begin / kBlockRows] = most;
    });
    double most = solids * solids;
    for (const Inlet& inlet : set_.inlets) most = std::max(most, inlet.speed * inlet.speed);
    for (const double square : f.partial) {
      if (!(square <= most)) most = square;
    }
    const double sound = d.solver == Method::wcsph ? set_.sound / std::sqrt(set_.lightest) : 0;
    const double half = 0.5 * (std::sqrt(most) + sound), reach = d.courant * d.spacing;
    // Speed that includes acceleration by gravity on the way.
    const double way = half + std::sqrt(half * half + norm(gravity) * reach);
    double out = way > 0 ? reach / way : way == 0 ? HUGE_VAL : way;
    if (const double g = norm(gravity); g > 0 && d.solver != Method::wcsph) {
      out = std::min(out, kFall * std::sqrt(d.spacing / g));
      if (d.solver == Method::pbf) {
        const double under = std::max(
            depth<D>(s.span<T>(columns::position).data(), f.n, gravity / g, f.partial, arena), d.spacing);
        const double most = d.pbf_iterations == 1 ? kCarriedByOne : kCarried;
        out = std::min(out, d.spacing * std::sqrt(most * d.pbf_iterations / (g * under)));
        // Not by the pressures found: those of a shorter substep are larger, and would shorten the next.
        if (set_.ratio) {
          const double load = load_by_weight<D>(set_, s.span<T>(columns::position).data(),
                                                s.span<T>(set_.ratio).data(), f.n, gravity, f.partial);
          const double layers = std::min(most, kCarriedLayers) * d.pbf_iterations;
          if (load > 0) out = std::min(out, d.spacing * std::sqrt(layers / load));
        }
      }
    }
    if (set_.ratio && d.solver == Method::dfsph && norm(gravity) > 0) {
      const T* ratio = s.span<T>(set_.ratio).data();
      const double found = load_of_pressures(s.span<T>(columns::push).data(), s.span<T>(columns::flow).data(),
                                             ratio, f.n, f.partial, arena);
      const double weight =
          load_by_weight<D>(set_, s.span<T>(columns::position).data(), ratio, f.n, gravity, f.partial);
      out = std::min(out, kHeld * d.spacing / std::sqrt(std::min(found, kMostOverWeight * weight)));
    }
    if (d.surface_tension > 0) {
      const double inertia = d.density * set_.lightest * d.spacing * d.spacing * d.spacing;
      out = std::min(out, kCapillary * std::sqrt(inertia / d.surface_tension));
    }
    if (viscous_) out = std::min(out, kDiffusion * set_.support * set_.support / d.viscosity);
    return out;
  }

  /// One substep of h s from `t`.
  void substep(State& s, Fluid<D, T>& f, BodiesIn<D, T>& bodies, const Vec3& gravity, const StepInput& in,
               double t, double h, Tracks& tracks) const {
    const SphDef& d = set_.def;
    const bool places = d.solver == Method::pbf;
    if (places) {
      fall(s, gravity, t, static_cast<T>(h), in.arena);
      bodies.pull(f, gravity, h), bodies.advance(h);
    }
    {
      const ProfileScope scope(in.profile, "sph neighbours");
      neighbours_.sort(f, s.span<T>(columns::position).data(), in.arena);
      walls_.shares(f, places ? t + h : t, in.arena);
      if (bodies.any()) bodies.touch(f, in.arena);
      if (f.weighted) weigh(s, f, t, in.arena);
      neighbours_.list(f, in.arena);
      load(s, f, norm(gravity), in.arena);
    }
    const ProfileScope scope(in.profile, "sph pressure");
    if (places) {
      pbf_.correct(f, bodies, t + h, h, in.arena);
      tracks.density += d.pbf_iterations;
    }
    forces(f, places ? Vec3{} : gravity, t, static_cast<T>(h), in.arena);
    if (implicit_) tracks.viscous += viscosity_.solve(f, t, h, in.arena);
    if (!places) bodies.lean(f, gravity, h), bodies.pull(f, gravity, h);
    if (viscous_ && d.walls == Walls::no_slip) bodies.hold(f, h);
    if (d.solver == Method::wcsph) wcsph_.advance(f, bodies, gravity, h, in.arena);
    if (d.solver == Method::dfsph) {
      // Substeps that a load makes short must not separate an overlap of the start as much faster.
      const double g = norm(gravity), longest = g > 0 ? kFall * std::sqrt(d.spacing / g) : h;
      const double share = set_.ratio && t < kSettling * longest ? std::min(h / longest, 1.0) : 1;
      const auto [flow, push] = dfsph_.solve(f, bodies, h, share, in.arena);
      tracks.flow += flow.iterations, tracks.density += push.iterations;
    }
    const bool both = d.solver == Method::wcsph;
    const auto error = f.tally(in.arena, [&](size_t i, const Chunk<T>&, size_t, size_t) {
      const double e = double{f.delta[i]} - 1;
      return std::array<double, 2>{both ? std::abs(e) : std::max(e, 0.0), 0};
    });
    tracks.mean = error.sum / std::max(static_cast<double>(f.n), 1.0), tracks.most = error.most;
    move(s, f, t + h, static_cast<T>(h), in.arena);
    if (!places) bodies.advance(h);
    if (!set_.inlets.empty()) pour(set_, s, t + h, in.workspace);
  }

  /// Gravity, viscosity, surface tension.
  void forces(Fluid<D, T>& f, const Vec3& gravity, double t, T h, const ThreadArena& arena) const {
    const T g[3] = {static_cast<T>(gravity.x), static_cast<T>(gravity.y), static_cast<T>(gravity.z)};
    const SphDef& d = set_.def;
    const bool leans = norm2(gravity) > 0;
    const bool holds = viscous_ && d.walls == Walls::no_slip;
    const T viscosity = static_cast<T>(viscous_ ? 2 * d.viscosity : 0), blend = static_cast<T>(60 * d.xsph);
    f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
      T* out = f.a.data() + 4 * i;
      const T* v = f.v.data() + 4 * i;
      out[0] = g[0], out[1] = g[1], out[2] = D == 3 ? g[2] : T{0}, out[3] = 0;
      if (viscosity > 0 || blend > 0) {
        using W = Wide<T>;
        W sums[D];
        for (auto& x : sums) x = W::zero();
        for (size_t k = begin; k < end; k += W::kLanes) {
          W other[4];
          c.rows_of(f.v, k, other);
          W share = W::all(-viscosity) * sph::load(c.s.data() + k);
          if (blend > 0) share += W::all(blend) * sph::load(c.w.data() + k);
          if (f.weighted) share = share * part_of_pair(f, i, c, k);
          for (size_t a = 0; a < D; ++a) sums[a] = madd(share, other[a] - W::all(v[a]), sums[a]);
        }
        for (size_t a = 0; a < D; ++a) out[a] += sum(sums[a]);
      }
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
        f.light[k] = f.held[k] ? T{0} : ratio ? 1 / ratio[f.row[k]] : T{1};
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

  /// Velocities and positions after h s from t under gravity alone.
  void fall(State& s, const Vec3& gravity, double t, T h, const ThreadArena& arena) const {
    const double after = t + double{h};
    T *x = s.span<T>(columns::position).data(), *v = s.span<T>(columns::velocity).data();
    const T g[3] = {static_cast<T>(gravity.x), static_cast<T>(gravity.y), static_cast<T>(gravity.z)};
    arena.for_blocks(s.rows(columns::position), kBlockRows, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        T unused[3] = {}, place[3] = {};
        const bool free = set_.inlets.empty() ||
                          !nozzle_at({double{x[3 * i]}, double{x[3 * i + 1]}, double{x[3 * i + 2]}}, t);
        for (size_t a = 0; a < D; ++a)
          place[a] = x[3 * i + a] + h * (v[3 * i + a] + (free ? h * g[a] : T{0}));
        walls_.keep_inside(place, unused, after);
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
    const bool carried = set_.def.solver == Method::wcsph;
    const T sound = static_cast<T>(set_.sound), per_layer = static_cast<T>(1 / (set_.def.spacing * weight));
    arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        const size_t i = f.row[k];
        for (size_t a = 0; a < 3; ++a) f.v[4 * k + a] = v[3 * i + a];
        f.v[4 * k + 3] = 0;
        f.push[k] = push[i], f.flow[k] = flow[i];
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
    const T on = set_.def.solver == Method::pbf ? T{0} : h;
    const T rest = static_cast<T>(set_.def.density), sound = static_cast<T>(set_.sound);
    arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        const size_t i = f.row[k];
        T place[3] = {}, speed[3] = {};
        for (size_t a = 0; a < D; ++a) speed[a] = f.v[4 * k + a], place[a] = f.x[a][k] + on * speed[a];
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

  /// Fraction of the period of the shortest wave of surface tension: sqrt(rho s^3 / (2 pi sigma)) over 2.5.
  static constexpr double kCapillary = 0.16;
  /// Fraction of the time in which a particle falls half a spacing: with longer substeps a pool does not come
  /// to rest.
  static constexpr double kFall = 0.09;
  /// For pbf, the largest g H (h / s)^2 per iteration of a substep at which the compression of a pool H deep
  /// stays in order: at twice as much, corrections shoot particles out. A single iteration, which no second
  /// one corrects, overshoots much earlier.
  static constexpr double kCarried = 0.09, kCarriedByOne = 0.012;
  /// The same between liquids of different density, by the load on the lightest (layer_load.h): at 0.2 two of
  /// 100:1 burst, at 0.02 the first corrections add 2 % of energy.
  static constexpr double kCarriedLayers = 0.04;
  /// For dfsph between such liquids, the largest h sqrt(p / rho) / s, p and rho of a particle: at 1.3 the
  /// light liquid collapses. What separates an overlap counts up to so many weights.
  static constexpr double kHeld = 0.6, kMostOverWeight = 4;
  static constexpr double kSettling = 20;  ///< longest substeps, in which an overlap of the start separates
  static constexpr double kDiffusion = 0.03;  ///< of the squared kernel radius: Morris, Fox & Zhu 1997

  const Setting& set_;
  Neighbours<D, T> neighbours_;
  BoxWalls<D, T> walls_;
  Dfsph<D, T> dfsph_;
  Wcsph<D, T> wcsph_;
  Pbf<D, T> pbf_;
  ImplicitViscosity<D, T> viscosity_;
  bool viscous_ = false;   ///< explicit viscosity, by short enough substeps
  bool implicit_ = false;  ///< by a solve
};

template <class T>
std::unique_ptr<const Solver> of_dimension(const Setting& s) {
  if (s.def.dimension == 2) return std::make_unique<SolverOf<2, T>>(s);
  return std::make_unique<SolverOf<3, T>>(s);
}

}  // namespace

std::unique_ptr<const Solver> make_solver(const Setting& s) {
  return s.def.precision == Precision::f32 ? of_dimension<float>(s) : of_dimension<double>(s);
}

}  // namespace truestep::sph
