// Collision detection of rigid bodies in the plane: what a solver includes.
//
//   once       Outline s = box(.5, .5);  area_of(s)            outline.h; values, cheap to copy
//   each step  boxes[i] = bounds(s, pose).grown(margin);       flat boxes for the broad phase of
//                                                              engine/collision/broad/broad_phase.h
//              touch(a, b, pose_a.to(pose_b), margin, c)       contact.h; points and normal in a's frame
//   fast ones  time_of_impact(a, sweep_a, b, sweep_b, gap)     distance.h
//   queries    distance, overlap, ray_cast                     distance.h
//
// All operations are + - * / and sqrt (sweeps: trig.h): the same bits on every machine.
#pragma once
#include "engine/collision/flat/contact.h"
#include "engine/collision/flat/distance.h"
#include "engine/collision/flat/outline.h"
