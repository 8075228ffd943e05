// What elastic bodies give out: energies, momenta, stresses and strains.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/equations/force_outputs.h"
#include "engine/core/outputs/outputs_of.h"
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

// Numbers for every element: write(means, its row of so many).
template <class Write>
auto of_elements(Write write) {
  return [write](const Fem& f, const State& s, const FieldAt& at) -> const void* {
    const size_t width = at.info.width;
    at.scratch.resize(at.rows.count * width);
    each_element(f.elements(), s,
                 [&](size_t k, const ElementMeans& m) { write(m, at.scratch.data() + width * k); });
    return at.scratch.data();
  };
}

}  // namespace

struct Fem::Whole : ForceEnergies {
  double elastic = 0, external = 0, moved = 0, least = HUGE_VAL, pins = 0;
  Vec3 momentum{}, angular_momentum{}, held{};
  std::optional<double> contact{}, gap{}, pairs{};  ///< with a barrier
};

const OutputTable& Fem::outputs() {
  using C = FemColumns;
  using W = Whole;
  static const OutputTable kTable =
      OutputsOf<Fem>(
          "a node: in a block x fastest, then y, then z; in a quad from the first corner to the second; in a "
          "mesh in the given order; nodes between corners come after all corners")
          .part("", [](const Fem& f) { return points_part(f.body().mesh.x.size()); })
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(C::position), "")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(C::velocity), "")
          .field({"displacement", "m", Scalar::f64, 3}, computed_by<Fem>(&Fem::displacement),
                 "from the node's rest position")
          .field({"von_mises", "Pa"}, computed_by<Fem>(&Fem::nodal_von_mises),
                 "mean of the elements at the node")
          .part(
              "elements",
              [](const Fem& f) { return values_part(f.body().mesh.cells(), PartInfo::Elements::triangles); })
          .field({"elements.stress", "Pa", Scalar::f64, 6},
                 of_elements([](const ElementMeans& m, double* out) { std::copy_n(m.stress, 6, out); }),
                 "of part elements, one row per element: Cauchy stress, xx yy zz xy yz xz")
          .field({"elements.strain", "1", Scalar::f64, 6},
                 of_elements([](const ElementMeans& m, double* out) { std::copy_n(m.strain, 6, out); }),
                 "Green strain, (F^T F - 1) / 2; with the linear law the symmetric gradient")
          .field({"elements.von_mises", "Pa"},
                 of_elements([](const ElementMeans& m, double* out) { *out = von_mises(m.stress); }),
                 "of the stress")
          .field({"elements.energy_density", "J/m^3"},
                 of_elements([](const ElementMeans& m, double* out) { *out = m.energy; }),
                 "per volume at rest")
          .field({"elements.jacobian", "1"},
                 of_elements([](const ElementMeans& m, double* out) { *out = m.least; }),
                 "smallest volume ratio, det F; 0 or less: inverted")
          .measured(
              &Fem::whole,
              {{"energy.kinetic", "J", &W::kinetic, "of motion; 0 in quasi-static motion"},
               {"energy.potential", "J", &W::potential, "elastic and external"},
               {"energy.total", "J", &W::total, "kinetic and potential"},
               {"energy.elastic", "J", &W::elastic, "of the elements"},
               {"energy.external", "J", &W::external, "of gravity, loads and user forces; pressure has none"},
               {"momentum", "kg m/s", &W::momentum, "of all free nodes"},
               {"angular_momentum", "kg m^2/s", &W::angular_momentum, "about the origin, of all free nodes"},
               {"displacement.max", "m", &W::moved, "largest of any node"},
               {"jacobian.min", "1", &W::least, "smallest det F at any quadrature point"},
               {"pins", "1", &W::pins, "nodes that are fixed in all directions"},
               {"reaction", "N", &W::held, "of all supports on the body"},
               {"energy.contact", "J", &W::contact, "of the barrier, not part of the total"},
               {"contact.gap", "m", &W::gap,
                "smallest distance seen by the barrier, at most contact_distance"},
               {"contact.pairs", "1", &W::pairs,
                "of the barrier: pairs of features nearer than contact_distance"}})
          .measured_each(
              [](const Fem& f) {
                std::vector<std::string> numbers;
                for (size_t k = 0; k < f.frequencies_.size(); ++k) numbers.push_back(std::to_string(k + 1));
                return numbers;
              },
              [](const Fem& f, const State&, double, size_t k) { return std::array{f.frequencies_[k]}; },
              {{"frequency.<number>", "1/s", entry<0>, "natural frequencies at rest, as many as modes"}})
          .build();
  return kTable;
}

const Outputs& fem_outputs() {
  static const Outputs kDescribed = Fem::outputs().described();
  return kDescribed;
}

Fem::Whole Fem::whole(const State& s, double t) const {
  Whole out{force_energies(*this, s, t)};
  static const ThreadArena kSerial(1);
  const Phase at{t, s.f64(Columns::position), s.f64(Columns::velocity), s};
  out.elastic = elements_.elastic(at, kSerial), out.external = elements_.external(at);
  const auto w = s.f64(Columns::inverse_mass);
  const Body& b = body();
  std::vector<double> f(at.x.size());
  Workspace workspace;
  Evaluation e{workspace, kSerial};
  elements_.elastic_forces(at, f, e);
  const Vec3 g = load3(s.f64(Columns::gravity).data(), 0);
  const double share = elements_.load_share(t), weight = motion_ == Motion::quasi_static ? share : 1;
  for (size_t i = 0; i < w.size(); ++i) {
    const Vec3 x = load3(at.x.data(), i), displacement = x - b.mesh.x[i];
    out.moved = std::max(out.moved, norm(displacement));
    if (w[i] > 0 && motion_ == Motion::dynamic) {
      const Vec3 mv = b.masses[i] * load3(at.v.data(), i);
      out.momentum += mv, out.angular_momentum += cross(x, mv);
    }
    out.pins += !(w[i] > 0);
    // Forces on the node other than the support's.
    const Vec3 rest = load3(f.data(), i) + share * load3(b.loads.data(), i) + weight * b.masses[i] * g;
    const double r[3] = {rest.x, rest.y, rest.z};
    double support[3] = {};
    for (size_t c = 0; c < 3; ++c) {
      if (!(w[i] > 0) || b.axes[i] >> c & 1) support[c] = -r[c];
    }
    out.held += Vec3{support[0], support[1], support[2]};
  }
  each_element(elements_, s,
               [&](size_t, const ElementMeans& m) { out.least = std::min(out.least, m.least); });
  if (barrier_) {
    const BarrierStep::Report r = barrier_->report(s, t);
    out.contact = r.energy, out.gap = r.least_gap, out.pairs = static_cast<double>(r.touching);
  }
  return out;
}

void Fem::displacement(const State& s, ShownRows rows, double* out) const {
  const auto x = s.f64(Columns::position);
  for (size_t i = 0; i < rows.count; ++i) store3(out, i, load3(x.data(), i) - body().mesh.x[i]);
}

void Fem::nodal_von_mises(const State& s, ShownRows rows, double* out) const {
  std::fill_n(out, rows.count, 0.0);
  std::vector<double> volumes(rows.count, 0);
  each_element(elements_, s, [&](size_t k, const ElementMeans& m) {
    double volume = 0;
    const CellRule rule = elements_.rule(k);
    for (size_t q = 0; q < rule.points; ++q) volume += rule.weights[q];
    for (const uint32_t p : body().mesh.cell(k)) out[p] += volume * von_mises(m.stress), volumes[p] += volume;
  });
  for (size_t i = 0; i < rows.count; ++i) out[i] /= volumes[i];
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

}  // namespace truestep::fem
