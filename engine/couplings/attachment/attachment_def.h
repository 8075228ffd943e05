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

const DefTable& attachment_table();
/// `a` and `b` are what the two systems cost by themselves.
Cost attachment_cost(const void* def, const Cost& a, const Cost& b);

}  // namespace truestep::attachment
