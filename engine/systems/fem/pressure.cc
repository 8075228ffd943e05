// Pressure on the deformed surface: f_a = -p sum_q N_a (x_xi x x_eta). Its derivative is symmetric except for
// terms at the surface's rim (Belytschko, Liu, Moran 2000, section 6.4.4); the symmetric part is used.
#include <array>

#include "engine/systems/fem/fem_field.h"

namespace truestep::fem {

namespace {

struct Tangents {
  Vec3 along, across;
};
Tangents tangents(const Body& b, const Facet& f, const double* x, size_t q) {
  const Element& face = b.mesh.facet_kind(f);
  Tangents out;
  for (size_t a = 0; a < face.size(); ++a) {
    const Vec3 at = load3(x, b.mesh.facet_node(f, a)), g = face.gradient[q * face.size() + a];
    out.along += g.x * at, out.across += g.y * at;
  }
  if (b.plane) out.across = {0, 0, b.thickness};
  return out;
}

}  // namespace

void FemField::add_pressure(const Phase& at, std::span<double> f) const {
  const double share = load_share(at.t);
  for (const PressureFacet& p : body_.pressures) {
    const Element& face = body_.mesh.facet_kind(p.facet);
    for (size_t q = 0; q < face.points.size(); ++q) {
      const Tangents t = tangents(body_, p.facet, at.x.data(), q);
      const Vec3 push = (-share * p.pressure * face.weights[q]) * cross(t.along, t.across);
      for (size_t a = 0; a < face.size(); ++a) {
        const uint32_t node = body_.mesh.facet_node(p.facet, a);
        store3(f.data(), node, load3(f.data(), node) + face.shape[q * face.size() + a] * push);
      }
    }
  }
}

void FemField::add_pressure_slope(const Phase& at, BlockSparse& dfdx) const {
  const double share = load_share(at.t);
  for (const PressureFacet& p : body_.pressures) {
    const Element& face = body_.mesh.facet_kind(p.facet);
    const size_t n = face.size();
    for (size_t q = 0; q < face.points.size(); ++q) {
      const Tangents t = tangents(body_, p.facet, at.x.data(), q);
      for (size_t a = 0; a < n; ++a) {
        for (size_t b = 0; b < n; ++b) {
          // d(x_xi x x_eta) / dx_b d = N_b,xi d x x_eta + N_b,eta x_xi x d = v x d
          const Vec3 g = face.gradient[q * n + b];
          const Vec3 v = (-share * p.pressure * face.weights[q] * face.shape[q * n + a]) *
                         (g.y * t.along - g.x * t.across);
          const double turn[9] = {0, v.z, -v.y, -v.z, 0, v.x, v.y, -v.x, 0};  // v x, column by column
          const double back[9] = {0, -v.z, v.y, v.z, 0, -v.x, -v.y, v.x, 0};
          const uint32_t i = body_.mesh.facet_node(p.facet, a), j = body_.mesh.facet_node(p.facet, b);
          dfdx.add_block(dfdx.slot(i, j), turn, 0.5);
          dfdx.add_block(dfdx.slot(j, i), back, 0.5);
        }
      }
    }
  }
}

}  // namespace truestep::fem
