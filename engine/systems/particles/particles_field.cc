#include "engine/systems/particles/particles_field.h"

#include <cmath>

#include "engine/base/errors.h"
#include "engine/kernels/springs/spring.h"
#include "engine/systems/particles/pair_forces.h"

namespace truestep::particles {

namespace {

Dependence dependence_of(const ParticlesDef& d) {
  bool on_velocity = d.linear_drag > 0 || d.quadratic_drag > 0 || d.expression.has_value() ||
                     ((d.charge != 0 || !d.charges.empty()) && d.magnetic_field != Vec3{}) ||
                     (d.propulsion && d.propulsion->along == PropulsionDef::Along::velocity);
  for (const PairSpringDef& s : d.springs) on_velocity |= s.damping > 0;
  for (const PairForceDef& p : d.pair_forces) on_velocity |= std::holds_alternative<ViscosityDef>(p);
  return on_velocity ? Dependence::position_and_velocity : Dependence::position;
}

void add(std::span<double> a, size_t row, const Vec3& da) {
  store3(a.data(), row, load3<double>(a.data(), row) + da);
}

/// Compiles the three components together, reporting all faults at once.
ExpressionRows compile_expressions(const ExpressionDef& d) {
  ExpressionGraph graph;
  ExpressionNames names;
  int32_t number = 0;
  for (const char* name : {"x", "y", "z", "vx", "vy", "vz", "t", "m"}) {
    names.add_value(name, graph.variable(number++));
  }
  for (const NamedNumberDef& c : d.constants) names.add_value(c.name, graph.constant(c.value));
  std::vector<ExpressionGraph::Node> roots;
  std::vector<Issue> issues;
  const std::pair<const char*, const std::string*> parts[] = {{"fx", &d.fx}, {"fy", &d.fy}, {"fz", &d.fz}};
  const auto report = [&issues](const char* name, const std::string& text, const ExpressionFault& fault) {
    issues.push_back({std::string("/expression/") + name, "bad_expression", describe(fault, text),
                      '"' + text.substr(0, 80) + '"', "see the description of \"expression\"",
                      fault.did_you_mean, "N"});
  };
  for (const auto& [name, text] : parts) {
    try {
      roots.push_back(names.require(graph, *text));
    } catch (const ExpressionFault& fault) {
      report(name, *text, fault);
    }
  }
  if (issues.empty()) {
    try {
      return {graph, roots};
    } catch (const ExpressionFault& fault) {
      report("fx", d.fx, fault);
    }
  }
  throw Error("scene_invalid", issues[0].pointer + ": " + issues[0].message, issues);
}

}  // namespace

ParticlesField::ParticlesField(const ParticlesDef& def, const Vec3& gravity, uint64_t seed)
    : def_(def),
      colliders_(build_colliders(def.colliders)),
      gravity_(gravity),
      seed_(seed),
      capacity_(largest_count(def)),
      dependence_(dependence_of(def)),
      pair_laws_(pair_laws(def.pair_forces)) {
  if (def.expression) expression_ = compile_expressions(*def.expression);
}

State ParticlesField::initial_state() const {
  return particles_at_start(def_, colliders_, gravity_, seed_, capacity_);
}

Charges ParticlesField::charges(const State& s) const {
  return {has_charges(s) ? s.f64(columns::charge) : std::span<const double>(), def_.charge};
}

BodyForces ParticlesField::body_forces(const State& s) const {
  BodyForces f;
  f.gravity = vector_parameter(s, Parameter::gravity);
  f.wind = vector_parameter(s, Parameter::wind);
  f.linear_drag = parameter(s, Parameter::linear_drag);
  f.quadratic_drag = parameter(s, Parameter::quadratic_drag);
  f.attractors = s.f64(columns::attractors);
  f.electric = vector_parameter(s, Parameter::electric_field);
  f.magnetic = vector_parameter(s, Parameter::magnetic_field);
  if (f.electric != Vec3{} || f.magnetic != Vec3{}) {
    f.charge = def_.charge, f.charges = charges(s).each;
  }
  f.thrust = parameter(s, Parameter::thrust);
  if (def_.propulsion && def_.propulsion->along == PropulsionDef::Along::direction) {
    f.thrust_direction = normalized(def_.propulsion->direction, {0, 1, 0});
  }
  return f;
}

void ParticlesField::acceleration(const Phase& at, std::span<double> a, Evaluation& e) const {
  sum_forces(body_forces(at.state), at, a, e);
}

UniformFields ParticlesField::uniform_fields(const State& s) const {
  return {vector_parameter(s, Parameter::gravity), vector_parameter(s, Parameter::electric_field),
          vector_parameter(s, Parameter::magnetic_field), charges(s)};
}

bool ParticlesField::varies(const State& s) const {
  return s.rows(columns::attractors) > 0 || parameter(s, Parameter::linear_drag) != 0 ||
         parameter(s, Parameter::quadratic_drag) != 0 || parameter(s, Parameter::thrust) != 0 ||
         expression_.outputs() > 0 || def_.coulomb || !pair_laws_.empty() ||
         s.rows(columns::spring_rows) > 0 || columns::kHands.any(s);
}

void ParticlesField::varying_acceleration(const Phase& at, std::span<double> a, Evaluation& e) const {
  BodyForces body = body_forces(at.state);
  body.gravity = {};
  body.charge = 0, body.charges = {};
  sum_forces(body, at, a, e);
}

void ParticlesField::sum_forces(const BodyForces& body, const Phase& at, std::span<double> a,
                                Evaluation& e) const {
  const State& s = at.state;
  const ParticleArrays arrays{at.x.data(), at.v.data(), s.f64(columns::mass).data()};
  e.arena.for_blocks(a.size() / 3, kBlockRows, [&](size_t begin, size_t end) {
    body_accelerations(body, arrays, a.data(), begin, end);
    if (expression_.outputs() > 0) add_expression(at, arrays.mass, a.data(), begin, end);
  });
  if (!pair_laws_.empty()) add_pair_forces(pair_laws_, at, arrays.mass, a, e);
  if (def_.coulomb) add_coulomb(*def_.coulomb, charges(s), at, arrays.mass, a, e);
  if (s.rows(columns::spring_rows) > 0) add_springs(at, a);
  if (columns::kHands.any(s)) add_commands(at, a);
}

void ParticlesField::add_springs(const Phase& at, std::span<double> a) const {
  const auto rows = at.state.span<uint32_t>(columns::spring_rows);
  const double* values = at.state.f64(columns::spring_values).data();
  const double* mass = at.state.f64(columns::mass).data();
  for (size_t k = 0; k < rows.size() / 2; ++k) {
    const size_t i = rows[2 * k], j = rows[2 * k + 1];
    const Vec3 f = spring::force(load3(at.x.data(), j) - load3(at.x.data(), i),
                                 load3(at.v.data(), j) - load3(at.v.data(), i), values[3 * k],
                                 values[3 * k + 1], values[3 * k + 2]);
    add(a, i, f / mass[i]);
    add(a, j, -f / mass[j]);
  }
}

void ParticlesField::add_expression(const Phase& at, const double* mass, double* a, size_t begin,
                                    size_t end) const {
  const ExpressionRows::Column variables[] = {
      {at.x.data(), 3},     {at.x.data() + 1, 3}, {at.x.data() + 2, 3}, {at.v.data(), 3},
      {at.v.data() + 1, 3}, {at.v.data() + 2, 3}, {&at.t, 0},           {mass, 1}};
  constexpr size_t kChunk = 256;
  double force[3][kChunk];
  const ExpressionRows::Output outputs[] = {{force[0]}, {force[1]}, {force[2]}};
  for (size_t first = begin; first < end; first += kChunk) {
    const size_t stop = std::min(end, first + kChunk);
    expression_.run(variables, outputs, first, stop);
    for (size_t axis = 0; axis < 3; ++axis) {
      for (size_t i = first; i < stop; ++i) a[3 * i + axis] += force[axis][i - first] / mass[i];
    }
  }
}

void ParticlesField::add_commands(const Phase& at, std::span<double> a) const {
  const State& s = at.state;
  const double* mass = s.f64(columns::mass).data();
  for (size_t k = 0; k < columns::kHands.pushes(s); ++k) {
    const UserForces::Push p = columns::kHands.push(s, k);
    if (const auto i = row_of(s, p.who)) add(a, *i, p.force / mass[*i]);
  }
  for (size_t k = 0; k < columns::kHands.drags(s); ++k) {
    const UserForces::Drag d = columns::kHands.drag(s, k);
    const auto i = row_of(s, d.who);
    if (!i) continue;
    // Critically damped, so that the particle follows the drag without oscillating.
    const double m = mass[*i];
    const Vec3 pull = (d.target - load3(at.x.data(), *i)) * d.stiffness -
                      load3(at.v.data(), *i) * (2 * std::sqrt(d.stiffness * m));
    add(a, *i, pull / m);
  }
}

std::optional<double> ParticlesField::potential(const Phase& at, Evaluation& e) const {
  const State& s = at.state;
  const ParticleArrays arrays{at.x.data(), at.v.data(), s.f64(columns::mass).data()};
  const BodyForces body = body_forces(s);
  double sum = e.arena.sum_blocks(at.x.size() / 3, kBlockRows, [&](size_t begin, size_t end) {
    return body_potential(body, arrays, begin, end);
  });
  if (!pair_laws_.empty()) sum += pair_potential_energy(pair_laws_, at, e);
  if (def_.coulomb) sum += coulomb_energy(*def_.coulomb, charges(s), at, e);
  const auto rows = s.span<uint32_t>(columns::spring_rows);
  const double* values = s.f64(columns::spring_values).data();
  for (size_t k = 0; k < rows.size() / 2; ++k) {
    const double length = norm(load3(at.x.data(), rows[2 * k + 1]) - load3(at.x.data(), rows[2 * k]));
    sum += spring::energy(length, values[3 * k], values[3 * k + 1]);
  }
  return sum;
}

double ParticlesField::kinetic(const Phase& at, Evaluation& e) const {
  const double* mass = at.state.f64(columns::mass).data();
  return e.arena.sum_blocks(at.v.size() / 3, kBlockRows, [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = begin; i < end; ++i) sum += 0.5 * mass[i] * norm2(load3(at.v.data(), i));
    return sum;
  });
}

std::optional<ForceField::Stiffness> ParticlesField::stiffness(const State& s) const {
  Stiffness out;
  const auto mass = s.f64(columns::mass);
  if (mass.empty()) return out;
  const double lightest = *std::min_element(mass.begin(), mass.end());
  // A spring between two masses: omega^2 = k (1/m + 1/m); neighbours add up, bounded by twice the largest
  // sum.
  double stiffest = 0, damping = 0;
  const double* values = s.f64(columns::spring_values).data();
  for (size_t k = 0; k < s.rows(columns::spring_rows); ++k) {
    stiffest = std::max(stiffest, values[3 * k]);
    damping = std::max(damping, values[3 * k + 2]);
  }
  double fastest = 0;
  if (parameter(s, Parameter::quadratic_drag) > 0) {
    const double* v = s.f64(columns::velocity).data();
    const Vec3 wind = vector_parameter(s, Parameter::wind);
    for (size_t i = 0; i < mass.size(); ++i) fastest = std::max(fastest, norm(load3(v, i) - wind));
  }
  out.omega = 2 * std::sqrt(stiffest / lightest);
  out.damping = (parameter(s, Parameter::linear_drag) +
                 2 * parameter(s, Parameter::quadratic_drag) * fastest + 4 * damping) /
                lightest;
  return out;
}

Vec3 ParticlesField::single_acceleration(const State& s, double t, const Vec3& x, const Vec3& v,
                                         double mass) const {
  const double xs[3] = {x.x, x.y, x.z}, vs[3] = {v.x, v.y, v.z};
  double a[3];
  BodyForces body = body_forces(s);
  body.charges = {};  // it has no row yet, so it uses the system's charge
  body_accelerations(body, {xs, vs, &mass}, a, 0, 1);
  if (expression_.outputs() > 0) add_expression({t, xs, vs, s}, &mass, a, 0, 1);
  return load3(a, 0);
}

}  // namespace truestep::particles
