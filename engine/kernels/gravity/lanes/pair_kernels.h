// The innermost loops of gravity (pair_loops.h), compiled once for every kind of processor and chosen when
// the program runs. All choices give the same bits: eight doubles or sixteen floats are one unit everywhere.
#pragma once
#include <cstddef>
#include <cstdint>

namespace truestep::gravity {

enum class Sums : uint8_t { accelerations, accelerations_and_potentials };

/// Radius of the spline's support over its eps.
inline constexpr double kSplineSupport = 2.8;

/// eps (m) of a softened law; tiny (m^2) is below the square of any distance but 0.
struct LawNumbers {
  double eps = 0, tiny = 0;
};

/// Bodies as columns, padded to whole units of 8 with massless bodies; ax, ay, az are accumulated.
struct PairColumns {
  const double *x, *y, *z, *mu;
  double *ax, *ay, *az;
};

/// Velocities as well, for the rate of the acceleration; and one body's sums.
struct MotionColumns {
  const double *x, *y, *z, *vx, *vy, *vz, *mu;
  size_t rows;  ///< whole units
};
struct JerkSums {
  double a[3], j[3];
};

/// Loops over the bodies [i0, i1) and [j0, j1), all of which start and end with a unit.
struct DirectLoops {
  void (*cross)(const PairColumns&, const LawNumbers&, size_t i0, size_t i1, size_t j0, size_t j1);
  void (*own)(const PairColumns&, const LawNumbers&, size_t i0, size_t i1);
  /// sum_j mu_j p(r_ij) over the bodies of [j0, j1) from `first` on.
  double (*potential)(const PairColumns&, const LawNumbers&, size_t i, size_t first, size_t j0, size_t j1);
  /// Acceleration of body i and its rate of change; not for the spline.
  JerkSums (*jerk)(const MotionColumns&, const LawNumbers&, size_t i);
};

/// Positions of a group's bodies relative to its centre, and their sums; `rows` is a whole number of units of
/// 64 bytes.
template <class T>
struct GroupColumns {
  const T *x, *y, *z;
  T *ax, *ay, *az, *p;
  size_t rows;
};

/// A source relative to the group's centre.
template <class T>
struct alignas(4 * sizeof(T)) BodySource {
  T x, y, z, m;
};
struct alignas(16) NodeSource {
  float x, y, z, m;
  float s[8];  ///< BodyTree::Moments
};

template <class T, class Source>
using GroupLoop = void (*)(const GroupColumns<T>&, const Source*, size_t count, const LawNumbers&);

template <class T, class Source>
struct GroupLoops {
  GroupLoop<T, Source> accelerations, with_potentials;
  GroupLoop<T, Source> of(Sums sums) const {
    return sums == Sums::accelerations ? accelerations : with_potentials;
  }
};

struct LawLoops {
  DirectLoops direct;
  GroupLoops<float, BodySource<float>> bodies;
  GroupLoops<double, BodySource<double>> near_bodies;
  GroupLoops<float, NodeSource> nodes;
};

struct PairLoops {
  LawLoops newton, plummer, spline;
};

/// Those for this processor.
const PairLoops& pair_loops();
/// Those that every processor supports, for tests.
const PairLoops& plain_pair_loops();

}  // namespace truestep::gravity
