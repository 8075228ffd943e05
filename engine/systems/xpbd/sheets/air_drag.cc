#include "engine/systems/xpbd/sheets/air_drag.h"

#include "engine/kernels/springs/air.h"

namespace truestep::xpbd {

void AirFaces::build(std::span<const uint32_t> corners, size_t rows) {
  triangles.resize(corners.size() / 3), at.resize(corners.size());
  // Counted two places on, so that `begin` is right when the lists have been filled.
  begin.assign(rows + 2, 0);
  for (const uint32_t p : corners) ++begin[p + 2];
  for (size_t i = 2; i < begin.size(); ++i) begin[i] += begin[i - 1];
  for (uint32_t f = 0; f < triangles.size(); ++f) {
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t p = triangles[f][k] = corners[3 * f + k];
      at[begin[p + 1]++] = f;
    }
  }
  begin.pop_back();
}

AirDrag::AirDrag(const Body& body, const AirOptions& options, double thickness) : options_(options) {
  if (!body.triangles.empty()) {
    faces_.build({body.triangles.front().data(), 3 * body.triangles.size()}, body.x.size());
    return;
  }
  // Each point carries half of each of its links.
  section_.assign(body.x.size(), 0);
  for (const Link& l : body.links) {
    for (const uint32_t p : {l.a, l.b}) section_[p] += 0.5 * thickness * l.rest;
  }
}

template <class T>
void AirDrag::blow(const Vec3& wind, const Vec3& gravity, double h, const AirRows<T>& on,
                   const AirFaces* torn, std::vector<Vec3>& impulses, const ThreadArena& arena) const {
  const AirFaces& faces = torn ? *torn : faces_;
  const double q = options_.factor;
  const auto weight = [&](uint32_t p) { return double{on.rows[4 * size_t{p} + 3]}; };
  // Air acts on the velocities after this substep's gravity, so drag balances weight at the terminal
  // velocity.
  const auto velocity = [&](uint32_t p) {
    const T* v = on.velocity + 4 * size_t{p};
    return weight(p) > 0 ? Vec3{v[0], v[1], v[2]} + gravity * h : Vec3{};
  };
  const auto place = [&](uint32_t p) {
    const T* x = on.rows + 4 * size_t{p};
    return load3(on.start, p) + Vec3{x[0], x[1], x[2]};
  };
  const auto add = [&](uint32_t p, const Vec3& impulse) {
    const Vec3 by = impulse * weight(p);
    T* v = on.velocity + 4 * size_t{p};
    v[0] += static_cast<T>(by.x), v[1] += static_cast<T>(by.y), v[2] += static_cast<T>(by.z);
  };
  if (faces.triangles.empty()) {
    arena.for_blocks(section_.size(), kBlockRows, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const auto p = static_cast<uint32_t>(i);
        const Vec3 u = wind - velocity(p);
        const auto [alpha, beta] = air::cylinder_slope(u, q, section_[i]);
        const double slope = alpha + beta * norm2(u);
        add(p, air::cylinder_force(u, q, section_[i]) * (h / (1 + h * slope * weight(p))));
      }
    });
    return;
  }
  // A point yields to all its triangles, which push it about as hard as this one does.
  const auto gives = [&](uint32_t p) { return weight(p) * (faces.begin[p + 1] - faces.begin[p]); };
  impulses.resize(faces.triangles.size());
  arena.for_blocks(faces.triangles.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) {
      const auto [a, b, c] = faces.triangles[f];
      const Vec3 x = place(a), area2 = cross(place(b) - x, place(c) - x);
      const Vec3 u = wind - (velocity(a) + velocity(b) + velocity(c)) * (1.0 / 3);
      const double yields =
          h * air::plate_slope(area2, u, q) * norm2(area2) * (gives(a) + gives(b) + gives(c)) / 9;
      impulses[f] = air::plate_force(area2, u, q) * (h / 3 / (1 + yields));
    }
  });
  arena.for_blocks(faces.begin.size() - 1, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Vec3 sum;
      for (uint32_t k = faces.begin[i]; k < faces.begin[i + 1]; ++k) sum += impulses[faces.at[k]];
      add(static_cast<uint32_t>(i), sum);
    }
  });
}

template void AirDrag::blow(const Vec3&, const Vec3&, double, const AirRows<float>&, const AirFaces*,
                            std::vector<Vec3>&, const ThreadArena&) const;
template void AirDrag::blow(const Vec3&, const Vec3&, double, const AirRows<double>&, const AirFaces*,
                            std::vector<Vec3>&, const ThreadArena&) const;

}  // namespace truestep::xpbd
