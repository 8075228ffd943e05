// Rows of three components that an implicit step must leave on surfaces (Baraff, Witkin 1998, "Large steps in
// cloth simulation", section 5): along `normal`, or in every direction if friction makes them stick, the
// velocity at the step's end is prescribed. The remaining directions are solved for, so neighbours of such a
// row see its position: moved back only after the step, the row would stretch springs that were at rest. The
// system's contact stage fills the columns; the methods that read them (the implicit Euler methods) report
// the impulse that the surfaces had to supply.
#pragma once
#include <optional>
#include <span>

#include "engine/core/state/state.h"
#include "engine/math/vec3.h"

namespace truestep {

struct RowContacts {
  enum Kind : uint32_t { kFree, kSlides, kSticks };
  std::span<uint32_t> kind;
  std::span<double> normal;    ///< 3 per row, unit
  std::span<double> velocity;  ///< 3 per row, m/s: at the step's end, for a sliding row along its normal
  std::span<double> drag;      ///< 3 per row, N s per step: friction on a sliding row
  std::span<double> impulse;   ///< 3 per row, N s: out, supplied by the surface

  /// Adds the columns, all rows free.
  static void add_columns(State& s, size_t rows) {
    s.add({"contact.kind", "1", Scalar::u32, 1}, rows);
    for (const char* name : {"contact.normal", "contact.velocity", "contact.drag", "contact.impulse"})
      s.add({name, name == std::string_view("contact.normal") ? "1" : "N s", Scalar::f64, 3}, rows);
  }
  /// The columns, if the state has them and some row is in contact.
  static std::optional<RowContacts> of(State& s) {
    const auto c = s.find("contact.kind");
    if (!c) return std::nullopt;
    const auto kinds = s.span<uint32_t>(*c);
    for (const uint32_t k : kinds) {
      if (k != kFree) return all(s);
    }
    return std::nullopt;
  }
  /// The columns, which must be there.
  static RowContacts all(State& s) {
    return {s.span<uint32_t>(s.at("contact.kind")), s.f64(s.at("contact.normal")),
            s.f64(s.at("contact.velocity")), s.f64(s.at("contact.drag")), s.f64(s.at("contact.impulse"))};
  }

  /// b without its component along prescribed directions.
  Vec3 left(size_t i, const Vec3& b) const {
    if (kind[i] == kFree) return b;
    if (kind[i] == kSticks) return {};
    const Vec3 n = load3(normal.data(), i);
    return b - n * dot(n, b);
  }
  /// u with its component along prescribed directions replaced.
  Vec3 given(size_t i, const Vec3& u) const {
    if (kind[i] == kFree) return u;
    const Vec3 v = load3(velocity.data(), i);
    if (kind[i] == kSticks) return v;
    const Vec3 n = load3(normal.data(), i);
    return u + n * dot(n, v - u);
  }
};

}  // namespace truestep
