// Parameters of the coupling type "attachment".
#pragma once
#include <optional>
#include <vector>

#include "engine/core/def/build.h"
#include "engine/core/def/def.h"
#include "engine/math/vec3.h"

namespace truestep::attachment {

struct AttachmentDef {
  enum class Link { spring, rigid } link = Link::spring;
  std::vector<int64_t> a_points{0}, b_points{0};
  double stiffness = 1000, damping = 0;
  std::optional<double> rest_length;
  std::vector<Vec3> places;
};

/// (h omega)^2 of a spring between its two points beyond which it is solved implicitly: half the stability
/// limit of its kicks.
inline constexpr double kMostKicked = 1;
/// The same when points respond together: forces solved for at a step's end do not balance the second half of
/// a kick, and the point visibly moves. Its kinetic energy is a quarter of this times the energy stored in
/// the spring.
inline constexpr double kMostKickedTogether = 0.01;

const DefTable& attachment_table();
/// `a` and `b` are the costs of the two systems alone.
Cost attachment_cost(const void* def, const Cost& a, const Cost& b);

}  // namespace truestep::attachment
