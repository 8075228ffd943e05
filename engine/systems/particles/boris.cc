#include "engine/systems/particles/boris.h"

#include <algorithm>
#include <cmath>

#include "engine/math/trig.h"
#include "engine/systems/particles/particles_field.h"

namespace truestep::particles {

namespace {

constexpr size_t kTurnBlock = 1024;

/// Half a rotation for all rows; particles with the same charge and mass share coefficients.
void turn(const UniformFields& f, std::span<const double> mass, std::span<double> x, std::span<double> v,
          double s, const ThreadArena& arena) {
  const double strength = norm(f.magnetic);
  const Vec3 unit = strength > 0 ? f.magnetic / strength : Vec3{0, 0, 1};
  arena.for_blocks(mass.size(), kTurnBlock, [&](size_t begin, size_t end) {
    double share = f.charge[begin] / mass[begin];
    UniformTurn turn(unit, share * strength, s);
    Vec3 a = f.gravity + f.electric * share;
    for (size_t i = begin; i < end; ++i) {
      if (const double next = f.charge[i] / mass[i]; next != share) {
        share = next;
        turn = UniformTurn(unit, share * strength, s);
        a = f.gravity + f.electric * share;
      }
      Vec3 xi = load3(x.data(), i), vi = load3(v.data(), i);
      turn.apply(xi, vi, a);
      store3(x.data(), i, xi), store3(v.data(), i, vi);
    }
  });
}

void step(const ForceField& field, State& s, const StepInput& in, const IntegratorOptions&) {
  const auto& particles = static_cast<const ParticlesField&>(field);
  const auto mass = s.f64(columns::mass);
  const auto x = s.f64(columns::position), v = s.f64(columns::velocity);
  if (mass.empty()) return;
  const UniformFields uniform = particles.uniform_fields(s);
  turn(uniform, mass, x, v, 0.5 * in.h, in.arena);
  if (particles.varies(s)) {
    const auto a = in.workspace.doubles("particles.boris.a", 3 * particles.capacity()).first(x.size());
    Evaluation e{in.workspace, in.arena};
    particles.varying_acceleration({in.t + 0.5 * in.h, x, v, s}, a, e);
    in.arena.for_blocks(x.size(), 3 * kTurnBlock, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) v[k] += in.h * a[k];
    });
  }
  turn(uniform, mass, x, v, 0.5 * in.h, in.arena);
}

/// Whether a word occurs in a text.
bool mentions(const std::string& text, std::string_view word) {
  const auto letter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
  for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const size_t end = at + word.size();
    if ((at == 0 || !letter(text[at - 1])) && (end == text.size() || !letter(text[end]))) return true;
  }
  return false;
}

}  // namespace

UniformTurn::UniformTurn(const Vec3& unit, double rate, double s) : unit_(unit), s_(s) {
  const double theta = rate * s, t = trig::tan(0.5 * theta), theta2 = theta * theta;
  sin_ = 2 * t / (1 + t * t);
  versine_ = t * sin_;
  if (std::fabs(theta) > 0.02) {
    c1_ = versine_ / theta, c2_ = 1 - sin_ / theta;
    d1_ = c2_ / theta, d2_ = 0.5 - c1_ / theta;
    return;
  }
  // Differences of nearly equal numbers; the first term left out is below 1e-19.
  c1_ = theta * (1.0 / 2 - theta2 * (1.0 / 24 - theta2 * (1.0 / 720 - theta2 / 40320)));
  d1_ = theta * (1.0 / 6 - theta2 * (1.0 / 120 - theta2 * (1.0 / 5040 - theta2 / 362880)));
  c2_ = theta * d1_;
  d2_ = theta2 * (1.0 / 24 - theta2 * (1.0 / 720 - theta2 * (1.0 / 40320 - theta2 / 3628800)));
}

void UniformTurn::apply(Vec3& x, Vec3& v, const Vec3& a) const {
  const auto across = [this](const Vec3& u) { return cross(u, unit_); };
  const Vec3 v1 = across(v), v2 = across(v1), a1 = across(a), a2 = across(a1);
  x += (v + v1 * c1_ + v2 * c2_) * s_ + (a * 0.5 + a1 * d1_ + a2 * d2_) * (s_ * s_);
  v += v1 * sin_ + v2 * versine_ + (a + a1 * c1_ + a2 * c2_) * s_;
}

std::optional<std::string> boris_refusal(const ParticlesDef& d) {
  if (d.charge == 0 && d.charges.empty()) return "the particles have no charge";
  if (d.linear_drag > 0 || d.quadratic_drag > 0) return "drag depends on the velocity";
  if (d.propulsion && d.propulsion->along == PropulsionDef::Along::velocity) {
    return "thrust along the velocity depends on the velocity";
  }
  if (std::any_of(d.springs.begin(), d.springs.end(), [](const auto& s) { return s.damping > 0; })) {
    return "damped springs depend on the velocity";
  }
  for (const PairForceDef& p : d.pair_forces) {
    if (std::holds_alternative<ViscosityDef>(p)) return "viscosity depends on the velocity";
  }
  if (d.expression) {
    for (const std::string* text : {&d.expression->fx, &d.expression->fy, &d.expression->fz}) {
      for (const char* word : {"vx", "vy", "vz"}) {
        if (mentions(*text, word)) return std::string("the expression depends on ") + word;
      }
    }
  }
  return std::nullopt;
}

const Integrator& boris() {
  static const Integrator kRow{.name = kBorisName,
                               .title = "Boris's pusher with the exact angle of gyration",
                               .order = 2,
                               .imaginary_limit = std::numeric_limits<double>::quiet_NaN(),
                               .real_limit = std::numeric_limits<double>::quiet_NaN(),
                               .structure = Integrator::Structure::symplectic,
                               .equations = Integrator::Equations::second_order,
                               .source =
                                   "Boris 1970, Proc. 4th Conf. Num. Sim. Plasmas, 3; Birdsall, Langdon "
                                   "1985, Plasma Physics via Computer Simulation, ch. 4",
                               .step = step};
  return kRow;
}

}  // namespace truestep::particles
