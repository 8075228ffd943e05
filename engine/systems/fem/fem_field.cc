#include "engine/systems/fem/fem_field.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/integrators/table/integrators.h"
#include "engine/math/trig.h"
namespace truestep::fem {

using Columns = FemColumns;

namespace {

constexpr size_t kBlockCells = 64;

double* stack_of(std::vector<double>& kept, size_t n) {
  if (kept.size() < n) kept.resize(n);
  return kept.data();
}

}  // namespace

FemField::FemField(const FemDef& def, const BuildContext& context)
    : body_(build_body(def)),
      law_(def.material),
      poisson_(def.poisson_ratio),
      second_(def.second_share),
      youngs_(def.youngs_modulus),
      damping_(def.damping),
      load_time_(def.load_time),
      motion_(def.motion),
      gravity_(context.gravity),
      velocity_(def.velocity),
      copies_(def.copies),
      dependence_(def.damping > 0 ? Dependence::position_and_velocity : Dependence::position) {
  if (body_.plane) gravity_.z = 0;
  const State s = initial_state();
  // Row sums bound the eigenvalues (Gershgorin).
  static const ThreadArena kSerial(1);
  Workspace workspace;
  Evaluation e{workspace, kSerial};
  BlockSparse dfdx, dfdv;
  jacobian_pattern(s, dfdx, dfdv);
  jacobian({0, s.f64(Columns::position), s.f64(Columns::velocity), s}, dfdx, dfdv, e);
  double most = 0;
  for (size_t i = 0; i < body_.masses.size(); ++i) {
    double sums[3] = {};
    for (auto k = dfdx.row_begin(i); k < dfdx.row_begin(i + 1); ++k) {
      const auto block = dfdx.block(k);
      for (size_t c = 0; c < 9; ++c) sums[c % 3] += std::abs(block[c]);
    }
    for (const double sum : sums) most = std::max(most, sum / body_.masses[i]);
  }
  omega_ = std::sqrt(most);
  const Integrator* method = find_integrator(def.integrator);
  if (method && method->name == "vertex_block_descent") colour_points();
}

State FemField::initial_state() const {
  State s;
  const size_t n = body_.mesh.x.size();
  s.add({"position", "m", Scalar::f64, 3, Role::position}, n);
  s.add({"velocity", "m/s", Scalar::f64, 3, Role::velocity}, n);
  s.add({"inverse_mass", "1/kg"}, n);
  s.add({"gravity", "m/s^2", Scalar::f64, 3}, 1);
  s.add({"parameters", "1"}, 2);
  s.add({"drag.row", "1", Scalar::u32}, 0);
  s.add({"drag.target", "m", Scalar::f64, 3}, 0);
  s.add({"drag.stiffness", "N/m"}, 0);
  s.add({"push.row", "1", Scalar::u32}, 0);
  s.add({"push.force", "N", Scalar::f64, 3}, 0);
  s.add({"push.remaining", "s"}, 0);
  s.add({"balance", "N", Scalar::f64, 3}, motion_ == Motion::quasi_static ? n : 0);
  if (motion_ == Motion::quasi_static) {
    s.add({"unbalanced", "N"}, 1);
    s.f64(Columns::unbalanced)[0] = -1;
  }
  for (size_t i = 0; i < n; ++i) {
    store3(s.f64(Columns::position).data(), i, body_.mesh.x[i]);
    double v[3] = {velocity_.x, velocity_.y, velocity_.z};
    for (size_t c = 0; c < 3; ++c) {
      if (body_.axes[i] >> c & 1) v[c] = 0;
    }
    store3(s.f64(Columns::velocity).data(), i, Vec3{v[0], v[1], v[2]});
    s.f64(Columns::inverse_mass)[i] = body_.axes[i] == 7 ? 0 : 1 / body_.masses[i];
  }
  for (size_t k = 0; k < body_.mesh.cells() && !copies_.empty(); ++k) {
    const Vec3& own = copies_[k / (body_.mesh.cells() / copies_.size())].velocity;
    for (const uint32_t p : body_.mesh.cell(k)) {
      double v[3] = {velocity_.x + own.x, velocity_.y + own.y, velocity_.z + own.z};
      for (size_t c = 0; c < 3; ++c) {
        if (body_.axes[p] >> c & 1) v[c] = 0;
      }
      store3(s.f64(Columns::velocity).data(), p, Vec3{v[0], v[1], v[2]});
    }
  }
  for (const uint32_t p : body_.pins) {
    s.f64(Columns::inverse_mass)[p] = 0;
    store3(s.f64(Columns::velocity).data(), p, Vec3{});
  }
  store3(s.f64(Columns::gravity).data(), 0, gravity_);
  s.f64(Columns::parameters)[0] = youngs_;
  s.f64(Columns::parameters)[1] = damping_;
  return s;
}

Material FemField::material(const State& s) const {
  return material_of(law_, s.f64(Columns::parameters)[0], poisson_, second_);
}

double FemField::cell_size() const {
  double volume = 0;
  for (const double w : body_.weights) volume += w;
  return trig::pow(volume / static_cast<double>(body_.mesh.cells()), 1.0 / 3);
}

double FemField::contact_stiffness(const State& s) const {
  return s.f64(Columns::parameters)[0] * cell_size();
}

CellRule FemField::rule(size_t cell) const {
  const size_t n = body_.size(), points = body_.points();
  return {n,
          points,
          body_.gradients.data() + cell * points * n,
          body_.weights.data() + cell * points,
          body_.mesh.sheet     ? Across::membrane
          : !body_.plane       ? Across::space
          : body_.plane_stress ? Across::plane_stress
                               : Across::plane_strain,
          body_.mean_volume,
          body_.modes,
          body_.mode_gradients.data() + cell * points * body_.modes};
}

void FemField::gather(const double* x, size_t cell, Vec3* out) const {
  for (const uint32_t p : body_.mesh.cell(cell)) *out++ = load3(x, p);
}

// Groups of one colour share no node, so each writes to its own.
template <class Work>
void FemField::by_colour(const ThreadArena& arena, Work work) const {
  for (size_t c = 0; c + 1 < body_.colours.size(); ++c) {
    const Body::Group* groups = body_.groups.data() + body_.colours[c];
    arena.for_blocks(body_.colours[c + 1] - body_.colours[c], 1, [&](size_t begin, size_t end) {
      for (size_t g = begin; g < end; ++g) {
        for (uint32_t cell = groups[g].begin; cell < groups[g].end; ++cell) work(cell);
      }
    });
  }
}

void FemField::elastic_forces(const Phase& at, std::span<double> f, Evaluation& e) const {
  std::fill(f.begin(), f.end(), 0.0);
  const Material m = material(at.state);
  by_colour(e.arena, [&](uint32_t cell) {
    std::array<Vec3, kMostNodes> x, forces{};
    gather(at.x.data(), cell, x.data());
    cell_forces(m, rule(cell), x.data(), forces.data());
    size_t a = 0;
    for (const uint32_t p : body_.mesh.cell(cell)) {
      store3(f.data(), p, load3(f.data(), p) + forces[a++]);
    }
  });
  if (!body_.bending.empty()) body_.bending.add_forces(flexural_rigidity(at.state), at.x, f, e.arena);
}

double FemField::flexural_rigidity(const State& s) const {
  const double h = body_.thickness;
  return s.f64(Columns::parameters)[0] * h * h * h / (12 * (1 - poisson_ * poisson_));
}

double FemField::load_share(double t) const {
  return load_time_ > 0 ? std::clamp(t / load_time_, 0.0, 1.0) : 1;
}

Vec3 FemField::gravity(const Phase& at) const {
  return (motion_ == Motion::quasi_static ? load_share(at.t) : 1) *
         load3(at.state.f64(Columns::gravity).data(), 0);
}

void FemField::free_axes_only(std::span<double> f) const {
  for (size_t i = 0; i < body_.axes.size(); ++i) {
    for (size_t c = 0; c < 3; ++c) {
      if (body_.axes[i] >> c & 1) f[3 * i + c] = 0;
    }
  }
}

void FemField::acceleration(const Phase& at, std::span<double> a, Evaluation& e) const {
  elastic_forces(at, a, e);
  if (!body_.pressures.empty()) add_pressure(at, a);
  const State& s = at.state;
  for (size_t k = 0; k < Columns::kHands.pushes(s); ++k) {
    const UserForces::Push push = Columns::kHands.push(s, k);
    store3(a.data(), push.who, load3(a.data(), push.who) + push.force);
  }
  for (size_t k = 0; k < Columns::kHands.drags(s); ++k) {
    const UserForces::Drag drag = Columns::kHands.drag(s, k);
    store3(a.data(), drag.who,
           load3(a.data(), drag.who) + drag.stiffness * (drag.target - load3(at.x.data(), drag.who)));
  }
  const auto balance = s.f64(Columns::balance);
  for (size_t k = 0; k < balance.size(); ++k) a[k] -= balance[k];
  const auto w = s.f64(Columns::inverse_mass);
  const Vec3 g = gravity(at);
  const double share = load_share(at.t), damping = s.f64(Columns::parameters)[1];
  e.arena.for_blocks(w.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3 load = share * load3(body_.loads.data(), i);
      Vec3 out = w[i] * (load3(a.data(), i) + load) + g - damping * load3(at.v.data(), i);
      if (!(w[i] > 0)) out = {};
      store3(a.data(), i, out);
    }
  });
  free_axes_only(a);
}

double FemField::elastic(const Phase& at, const ThreadArena& arena) const {
  const Material m = material(at.state);
  const double bent =
      body_.bending.empty() ? 0 : body_.bending.energy(flexural_rigidity(at.state), at.x, arena);
  return bent + arena.sum_blocks(body_.mesh.cells(), kBlockCells, [&](size_t begin, size_t end) {
    double sum = 0;
    std::array<Vec3, kMostNodes> x;
    for (size_t k = begin; k < end; ++k) {
      gather(at.x.data(), k, x.data());
      sum += cell_forces(m, rule(k), x.data(), nullptr);
    }
    return sum;
  });
}

double FemField::external(const Phase& at) const {
  const State& s = at.state;
  const Vec3 g = gravity(at);
  const double share = load_share(at.t);
  double v = 0;
  for (size_t i = 0; i < body_.masses.size(); ++i) {
    const Vec3 x = load3(at.x.data(), i);
    v -= body_.masses[i] * dot(g, x) + share * dot(load3(body_.loads.data(), i), x - body_.mesh.x[i]);
  }
  const auto balance = s.f64(Columns::balance);
  for (size_t k = 0; k < balance.size(); ++k) v += balance[k] * at.x[k];
  for (size_t k = 0; k < Columns::kHands.pushes(s); ++k) {
    const UserForces::Push push = Columns::kHands.push(s, k);
    v -= dot(push.force, load3(at.x.data(), push.who));
  }
  for (size_t k = 0; k < Columns::kHands.drags(s); ++k) {
    const UserForces::Drag drag = Columns::kHands.drag(s, k);
    v += 0.5 * drag.stiffness * norm2(drag.target - load3(at.x.data(), drag.who));
  }
  return v;
}

std::optional<double> FemField::potential(const Phase& at, Evaluation& e) const {
  return elastic(at, e.arena) + external(at);
}

// mu / 2 |F|^2 at rest, and the terms that cancel it: rounding is relative to this energy.
double FemField::cancelling_terms(const State& s) const {
  double volume = 0;
  for (const double w : body_.weights) volume += w;
  return 1.5 * material(s).mu * volume;
}

std::optional<double> FemField::dissipation(const Phase& at, Evaluation&) const {
  if (!body_.pressures.empty()) return std::nullopt;
  const double damping = at.state.f64(Columns::parameters)[1];
  if (!(damping > 0)) return 0;
  double r = 0;
  for (size_t i = 0; i < body_.masses.size(); ++i)
    r += 0.5 * damping * body_.masses[i] * norm2(load3(at.v.data(), i));
  return r;
}

double FemField::kinetic(const Phase& at, Evaluation&) const {
  if (motion_ == Motion::quasi_static) return 0;
  const auto w = at.state.f64(Columns::inverse_mass);
  double t = 0;
  for (size_t i = 0; i < w.size(); ++i) {
    if (w[i] > 0) t += 0.5 * body_.masses[i] * norm2(load3(at.v.data(), i));
  }
  return t;
}

std::span<const double> FemField::inverse_mass(const State& s) const {
  return s.f64(Columns::inverse_mass);
}

std::optional<ForceField::Stiffness> FemField::stiffness(const State& s) const {
  const auto p = s.f64(Columns::parameters);
  return Stiffness{omega_ * std::sqrt(p[0] / youngs_), p[1]};
}

void FemField::jacobian_pattern(const State&, BlockSparse& dfdx, BlockSparse& dfdv) const {
  dfdx.set_pattern(body_.mesh.x.size(), 3, body_.pairs);
  dfdv.set_pattern(body_.mesh.x.size(), 3, {});
}

void FemField::jacobian(const Phase& at, BlockSparse& dfdx, BlockSparse& dfdv, Evaluation& e) const {
  derivatives(at, Definite::no, dfdx, dfdv, e);
}
void FemField::definite_jacobian(const Phase& at, BlockSparse& dfdx, BlockSparse& dfdv, Evaluation& e) const {
  derivatives(at, Definite::yes, dfdx, dfdv, e);
}

void FemField::derivatives(const Phase& at, Definite definite, BlockSparse& dfdx, BlockSparse& dfdv,
                           Evaluation& e) const {
  const Material m = material(at.state);
  const size_t n = body_.size();
  dfdx.set_zero();
  by_colour(e.arena, [&](uint32_t cell) {
    std::array<Vec3, kMostNodes> x;
    gather(at.x.data(), cell, x.data());
    thread_local std::vector<double> kept;
    double* k = stack_of(kept, 9 * n * n);
    cell_stiffness(m, rule(cell), x.data(), definite, k);
    const BlockSparse::Slot* slots = body_.slots.data() + cell * n * n;
    for (size_t ab = 0; ab < n * n; ++ab) dfdx.add_block(slots[ab], k + 9 * ab, -1);
  });
  if (!body_.bending.empty()) {
    const BentSlope bent = definite == Definite::yes ? BentSlope::definite : BentSlope::exact;
    body_.bending.add_stiffness(flexural_rigidity(at.state), at.x, bent, dfdx, e.arena);
  }
  if (!body_.pressures.empty() && definite == Definite::no) add_pressure_slope(at, dfdx);
  const State& s = at.state;
  for (size_t k = 0; k < Columns::kHands.drags(s); ++k) {
    const UserForces::Drag drag = Columns::kHands.drag(s, k);
    const auto block = dfdx.block(dfdx.diagonal_slot(drag.who));
    for (size_t c = 0; c < 3; ++c) block[4 * c] -= drag.stiffness;
  }
  // Prescribed components neither move nor are moved.
  for (size_t i = 0; i < body_.axes.size(); ++i) {
    for (auto k = dfdx.row_begin(i); k < dfdx.row_begin(i + 1); ++k) {
      const uint8_t rows = body_.axes[i], columns = body_.axes[dfdx.column(k)];
      if (!(rows | columns)) continue;
      const auto block = dfdx.block(k);
      for (size_t c = 0; c < 9; ++c) {
        if ((rows >> (c % 3) & 1) | (columns >> (c / 3) & 1)) block[c] = 0;
      }
    }
  }
  dfdv.set_zero();
  const double damping = s.f64(Columns::parameters)[1];
  for (size_t i = 0; damping > 0 && i < body_.masses.size(); ++i) {
    const auto block = dfdv.block(dfdv.diagonal_slot(i));
    for (size_t c = 0; c < 3; ++c) block[4 * c] = body_.axes[i] >> c & 1 ? 0 : -damping * body_.masses[i];
  }
}

}  // namespace truestep::fem
