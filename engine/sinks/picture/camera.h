// The camera of a picture: the scene's own, or one that frames everything. A frustum of fixed orientation and
// half-angle tangent k contains a ball (c, r) when, in camera axes, |c.x| + k c.z <= k d - r sqrt(1 + k^2);
// the smallest d and the best centre follow from two maxima per axis.
#pragma once
#include "engine/sinks/picture/draw/draw_list.h"

namespace truestep::picture {

/// Orthonormal axes of a list: `up`, and two horizontal ones (`side` to the right of someone facing
/// `-front`).
struct Axes {
  Vec3 side, up, front;
};

/// Axes for any non-zero `up`; y-up gives side = x, front = z. A zero or non-finite `up` counts as +y.
Axes axes_of(const Vec3& up);

/// The list's camera if it is usable (finite, eye apart from target), otherwise one that frames every finite
/// point (with its radius) and every shape except planes in a picture of `aspect` = width / height, with a
/// margin.
DrawCamera camera_for(const DrawList& list, double aspect);

}  // namespace truestep::picture
