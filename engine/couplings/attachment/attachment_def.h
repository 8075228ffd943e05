// Parameters of the coupling type "attachment".
#pragma once
#include <optional>
#include <vector>

#include "engine/core/build.h"
#include "engine/core/def.h"
#include "engine/math/vec3.h"

namespace truestep::attachment {

struct AttachmentDef {
  enum class Link { spring, rigid } link = Link::spring;
  std::vector<int64_t> a_points{0}, b_points{0};
  double stiffness = 1000, damping = 0;
  std::optional<double> rest_length;
  std::vector<Vec3> places;
};

/// (h omega)^2 of a spring on its two places from which it is solved for: half of what its kicks are stable
/// at.
inline constexpr double kMostKicked = 1;
/// The same where points answer together: forces that are solved for at a step's end do not hold the second
/// half of a kick, and the point is seen to move by it. Its kinetic energy is a quarter of this times what
/// the spring stores.
inline constexpr double kMostKickedTogether = 0.01;

const DefTable& attachment_table();
/// `a` and `b` are what the two systems cost by themselves.
Cost attachment_cost(const void* def, const Cost& a, const Cost& b);

}  // namespace truestep::attachment
