// How the attraction of two bodies departs from Newton's at short distance. Per unit of mass and G:
//   acceleration towards the other = w(r) d,  potential = -p(r)
//   none     w = r^-3, p = 1/r, and 0 at r = 0
//   plummer  w = (r^2 + eps^2)^(-3/2), p = (r^2 + eps^2)^(-1/2)
//   spline   the field of a body spread by the cubic spline kernel of radius h = 2.8 eps (Monaghan &
//            Lattanzio 1985): Newton's beyond h, and as deep as Plummer's in the middle (Springel 2005,
//            eq. 71 and section 2)
// Written out in lanes/pair_loops.h. Not covered: individual softenings.
#pragma once
#include "engine/kernels/gravity/lanes/pair_kernels.h"

namespace truestep::gravity {

enum class SofteningKind : uint8_t { plummer, spline };

/// For all bodies. `length` eps in m, 0: none.
struct Softening {
  SofteningKind kind = SofteningKind::plummer;
  double length = 0;

  const LawLoops& loops(const PairLoops& all) const {
    return length == 0 ? all.newton : kind == SofteningKind::spline ? all.spline : all.plummer;
  }
};

}  // namespace truestep::gravity
