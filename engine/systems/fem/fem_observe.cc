// Energies, momenta, stresses and strains of a state.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/systems/fem/fem.h"

namespace truestep::fem {

using Columns = FemColumns;

namespace {

// From xx, yy, zz, xy, yz, xz.
double von_mises(const double* s) {
  const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
  return std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

// Means over an element: Cauchy stress, Green strain (small strain for the linear law), energy density, J.
struct ElementMeans {
  double stress[6] = {}, strain[6] = {}, energy = 0, least = HUGE_VAL;
};

void add_symmetric(double* out, double w, const Mat3& a) {
  out[0] += w * a(0, 0), out[1] += w * a(1, 1), out[2] += w * a(2, 2);
  out[3] += 0.5 * w * (a(0, 1) + a(1, 0)), out[4] += 0.5 * w * (a(1, 2) + a(2, 1));
  out[5] += 0.5 * w * (a(0, 2) + a(2, 0));
}

ElementMeans means_of(const Material& material, const CellRule& rule, const Vec3* x) {
  std::array<Response, kMostPoints> at;
  std::array<Mat3, kMostPoints> f;
  double whole = 0, theta = 0;
  for (size_t q = 0; q < rule.points; ++q) {
    f[q] = deformation(material, rule, x, q);
    respond(material, f[q], at[q], nullptr);
    whole += rule.weights[q], theta += rule.weights[q] * at[q].theta;
  }
  ElementMeans out;
  for (size_t q = 0; q < rule.points; ++q) {
    const double w = rule.weights[q] / whole, j = determinant(f[q]);
    const Volumetric u = volumetric(material, rule.mean_volume ? theta / whole : at[q].theta);
    const Mat3 p = at[q].p + u.du * at[q].dtheta;
    if (material.law == Law::linear) {
      add_symmetric(out.stress, w, p);
      add_symmetric(out.strain, w, f[q] - Mat3::identity());
    } else {
      add_symmetric(out.stress, w / j, p * transposed(f[q]));
      add_symmetric(out.strain, 0.5 * w, transposed(f[q]) * f[q] - Mat3::identity());
    }
    out.energy += w * (at[q].energy + u.u);
    out.least = std::min(out.least, j);
  }
  return out;
}

template <class Visit>
void each_element(const FemField& field, const State& s, Visit visit) {
  const Material m = field.material(s);
  std::array<Vec3, kMostNodes> x;
  for (size_t k = 0; k < field.body().mesh.cells(); ++k) {
    field.gather(s.f64(Columns::position).data(), k, x.data());
    visit(k, means_of(m, field.rule(k), x.data()));
  }
}

}  // namespace

void Fem::observe(const State& s, double t, Observables& out) const {
  ForceSystem::observe(s, t, out);
  static const ThreadArena kSerial(1);
  const Phase at{t, s.f64(Columns::position), s.f64(Columns::velocity), s};
  out.add("energy.elastic", elements_.elastic(at, kSerial), "J");
  out.add("energy.external", elements_.external(at), "J");
  const auto w = s.f64(Columns::inverse_mass);
  const Body& b = body();
  std::vector<double> f(at.x.size());
  Workspace workspace;
  Evaluation e{workspace, kSerial};
  elements_.elastic_forces(at, f, e);
  Vec3 p, l, held;
  double moved = 0;
  size_t pins = 0;
  const Vec3 g = load3(s.f64(Columns::gravity).data(), 0);
  const double share = elements_.load_share(t), weight = motion_ == Motion::quasi_static ? share : 1;
  for (size_t i = 0; i < w.size(); ++i) {
    const Vec3 x = load3(at.x.data(), i), displacement = x - b.mesh.x[i];
    moved = std::max(moved, norm(displacement));
    if (w[i] > 0 && motion_ == Motion::dynamic) {
      const Vec3 mv = b.masses[i] * load3(at.v.data(), i);
      p += mv, l += cross(x, mv);
    }
    pins += !(w[i] > 0);
    // Forces on the node other than the support's.
    const Vec3 rest = load3(f.data(), i) + share * load3(b.loads.data(), i) + weight * b.masses[i] * g;
    const double r[3] = {rest.x, rest.y, rest.z};
    double support[3] = {};
    for (size_t c = 0; c < 3; ++c) {
      if (!(w[i] > 0) || b.axes[i] >> c & 1) support[c] = -r[c];
    }
    held += Vec3{support[0], support[1], support[2]};
  }
  out.add("momentum.x", p.x, "kg m/s");
  out.add("momentum.y", p.y, "kg m/s");
  out.add("momentum.z", p.z, "kg m/s");
  out.add("angular_momentum.x", l.x, "kg m^2/s");
  out.add("angular_momentum.y", l.y, "kg m^2/s");
  out.add("angular_momentum.z", l.z, "kg m^2/s");
  out.add("displacement.max", moved, "m");
  double least = HUGE_VAL;
  each_element(elements_, s, [&](size_t, const ElementMeans& m) { least = std::min(least, m.least); });
  out.add("jacobian.min", least, "1");
  out.add("pins", static_cast<double>(pins), "1");
  out.add("reaction.x", held.x, "N");
  out.add("reaction.y", held.y, "N");
  out.add("reaction.z", held.z, "N");
  if (barrier_) {
    const BarrierStep::Report r = barrier_->report(s, t);
    out.add("energy.contact", r.energy, "J");
    out.add("contact.gap", r.least_gap, "m");
    out.add("contact.pairs", static_cast<double>(r.touching), "1");
  }
  for (size_t k = 0; k < frequencies_.size(); ++k) {
    out.add("frequency." + std::to_string(k + 1), frequencies_[k], "1/s");
  }
}

void Fem::warn(const State& s, double, std::vector<Warning>& out) const {
  out.insert(out.end(), locking_.begin(), locking_.end());
  if (motion_ == Motion::dynamic || elements_.material(s).law == Law::linear) return;
  double least = HUGE_VAL;
  each_element(elements_, s, [&](size_t, const ElementMeans& m) { least = std::min(least, m.least); });
  if (least > 0) return;
  out.push_back({"jacobian.min", least, 0,
                 "elements are inside out: the material does not resist collapse; neo_hookean does"});
}

FieldView Fem::field(const State& s, size_t part, size_t which, std::vector<double>& scratch) const {
  const size_t n = body().mesh.x.size(), cells = body().mesh.cells();
  if (part == 0 && which < 2) return ForceSystem::field(s, part, which, scratch);
  if (part == 0 && which == 2) {
    const auto x = s.f64(Columns::position);
    scratch.resize(3 * n);
    for (size_t i = 0; i < n; ++i) store3(scratch.data(), i, load3(x.data(), i) - body().mesh.x[i]);
    return {scratch.data(), Scalar::f64, n, 3};
  }
  if (part == 0) {
    // Mean over the elements at a node, weighted by volume.
    scratch.assign(n, 0);
    std::vector<double> volumes(n, 0);
    each_element(elements_, s, [&](size_t k, const ElementMeans& m) {
      double volume = 0;
      const CellRule rule = elements_.rule(k);
      for (size_t q = 0; q < rule.points; ++q) volume += rule.weights[q];
      for (const uint32_t p : body().mesh.cell(k))
        scratch[p] += volume * von_mises(m.stress), volumes[p] += volume;
    });
    for (size_t i = 0; i < n; ++i) scratch[i] /= volumes[i];
    return {scratch.data(), Scalar::f64, n, 1};
  }
  const uint32_t width = which < 2 ? 6 : 1;
  scratch.resize(width * cells);
  each_element(elements_, s, [&](size_t k, const ElementMeans& m) {
    if (which == 0) std::copy_n(m.stress, 6, &scratch[6 * k]);
    if (which == 1) std::copy_n(m.strain, 6, &scratch[6 * k]);
    if (which == 2) scratch[k] = von_mises(m.stress);
    if (which == 3) scratch[k] = m.energy;
    if (which == 4) scratch[k] = m.least;
  });
  return {scratch.data(), Scalar::f64, cells, width};
}

}  // namespace truestep::fem
