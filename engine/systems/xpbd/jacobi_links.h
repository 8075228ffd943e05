// Links solved simultaneously from the same positions, by Jacobi's method with or without Chebyshev weights
// (kernels/chebyshev.h). In the multipliers a sweep is (J W J^T + alpha~) d_lambda = b; each link takes
//   d_lambda = b / D,   D_l = w_a n_a + w_b n_b + alpha~     (n: links at a point),
// the sum of the absolute values in its row. This bounds the largest eigenvalue of D^-1 (J W J^T + alpha~) by
// 1 (Gershgorin), so every iteration converges where Jacobi's own diagonal may not. Weights act on positions
// and multipliers alike, so stiffness stays in N/m.
#pragma once
#include <vector>

#include "engine/base/parallel.h"
#include "engine/kernels/xpbd/compliance.h"
#include "engine/systems/xpbd/body.h"

namespace truestep::xpbd {

template <class T>
class JacobiLinks {
 public:
  bool empty() const { return a_.empty(); }
  /// `compliances`: m/N, of every link of the body.
  void prepare(const Body& body, const std::vector<double>& compliances);
  /// Positions at the step's start.
  void load(const double* x, const ThreadArena& arena);
  void forget_multipliers();
  /// Bound on the spectral radius: since J W J^T >= 0, no eigenvalue of D^-1 (J W J^T + alpha~) is below the
  /// smallest alpha~ / D of any link.
  double radius(const PerStep<T>& per) const;
  /// Moves the points of all rows (x, y, z, inverse mass) by one iteration, weighted by omega. Returns the
  /// largest q (kernels/xpbd/chain.h) of all points.
  T iterate(const PerStep<T>& per, T omega, T relax, T* rows, const ThreadArena& arena);

 private:
  void solve_links(const PerStep<T>& per, T omega, const T* rows, size_t begin, size_t end);

  std::vector<uint32_t> a_, b_;
  std::vector<T> rest_, compliance_, links_a_, links_b_;
  std::vector<T> base_, pull_;  // 3 a link
  std::vector<T> lambda_, before_, tension_;
  std::vector<uint32_t> begin_, at_;  // links of a point: twice the link's index, plus one at its second end
  std::vector<T> old_;                // 3 a point, from the previous iteration
  std::vector<T> q_;                  // per block
  size_t points_ = 0;
  double softness_ = 0;  // smallest compliance over D - alpha~ of all links
};

extern template class JacobiLinks<float>;
extern template class JacobiLinks<double>;

}  // namespace truestep::xpbd
