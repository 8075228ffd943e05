// Collision detection of rigid bodies in 3-D: what a solver includes, and how a step uses it.
//
//   once       Solid s = box_solid({.5, .5, .5});             solid.h; values, cheap to copy
//              MassProperties m = mass_properties(s, 1000);   centre of mass is m.center, not the origin:
//                                                             shift parts or poses so that it is
//   each step  Transform at = transform_of(pose);             one per body, kept for all pairs
//              boxes[i] = bounds(s, at).grown(margin);        grown by the speculative margin
//              for (BodyPair p : broad.update(boxes, mobility, fat))     sorted, no memory of earlier steps
//                if (collide(s_a, at_a, s_b, at_b, margin, manifold)) ...    convex pairs and planes; the
//                                                             overload with a vector takes meshes and the
//                                                             like
//              Points have a separation along the normal (a to b), negative when they overlap; a contact
//              row holds  separation + h n . (v_b - v_a) >= 0, so with margin >= h |v| nothing penetrates.
//              Match a pair's points of the last step by id for warm starting (all its manifolds); keep what
//              you match in the State, here nothing is remembered.
//   fast ones  bodies that move further than inner_radius(s) in a step: time_of_impact.h from pose to pose,
//              and stop them there.
//   queries    queries/queries.h: rays, casts, nearest points, overlap; over one solid or the broad phase.
//
// All operations are + - * / and sqrt, and run in the frame of one of the two bodies: the same bits on
// every machine, and far from the origin as accurate as the poses are.
#pragma once
#include "engine/collision/broad/broad_phase.h"
#include "engine/collision/pairs/collide.h"
#include "engine/collision/queries/queries.h"
#include "engine/collision/queries/time_of_impact.h"
#include "engine/geometry/mass_properties.h"
#include "engine/geometry/solid.h"
