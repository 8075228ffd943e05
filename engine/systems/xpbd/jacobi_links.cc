#include "engine/systems/xpbd/jacobi_links.h"

#include <algorithm>
#include <cmath>

namespace truestep::xpbd {

template <class T>
void JacobiLinks<T>::prepare(const Body& body, const std::vector<double>& compliances) {
  const size_t links = body.links.size();
  points_ = body.x.size();
  a_.clear(), b_.clear(), rest_.clear(), compliance_.clear();
  begin_.assign(points_ + 1, 0);
  for (size_t k = 0; k < links; ++k) {
    const Link& l = body.links[k];
    a_.push_back(l.a), b_.push_back(l.b);
    rest_.push_back(static_cast<T>(l.rest)), compliance_.push_back(static_cast<T>(compliances[k]));
    ++begin_[l.a + 1], ++begin_[l.b + 1];
  }
  for (size_t i = 0; i < points_; ++i) begin_[i + 1] += begin_[i];
  at_.resize(2 * links);
  std::vector<uint32_t> next(begin_.begin(), begin_.end() - 1);
  links_a_.clear(), links_b_.clear();
  for (uint32_t k = 0; k < links; ++k) {
    at_[next[a_[k]]++] = 2 * k, at_[next[b_[k]]++] = 2 * k + 1;
    links_a_.push_back(static_cast<T>(begin_[a_[k] + 1] - begin_[a_[k]]));
    links_b_.push_back(static_cast<T>(begin_[b_[k] + 1] - begin_[b_[k]]));
  }
  softness_ = HUGE_VAL;
  for (size_t k = 0; k < links; ++k) {
    const double own = static_cast<double>(links_a_[k]) / body.masses[a_[k]] +
                       static_cast<double>(links_b_[k]) / body.masses[b_[k]];
    softness_ = std::min(softness_, compliances[k] / own);
  }
  base_.resize(3 * links), pull_.resize(3 * links), tension_.resize(links);
  lambda_.assign(links, T(0)), before_.assign(links, T(0));
  old_.assign(3 * points_, T(0));
  q_.assign((points_ + kBlockRows - 1) / kBlockRows, T(0));
}

template <class T>
void JacobiLinks<T>::load(const double* x, const ThreadArena& arena) {
  arena.for_blocks(a_.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      for (size_t c = 0; c < 3; ++c) base_[3 * k + c] = static_cast<T>(x[3 * b_[k] + c] - x[3 * a_[k] + c]);
    }
  });
}

template <class T>
void JacobiLinks<T>::forget_multipliers() {
  std::fill(lambda_.begin(), lambda_.end(), T(0));
}

template <class T>
double JacobiLinks<T>::radius(const PerStep<T>& per) const {
  return 1 / (1 + softness_ * static_cast<double>(per.h2));
}

template <class T>
void JacobiLinks<T>::solve_links(const PerStep<T>& per, T omega, const T* rows, size_t begin, size_t end) {
  for (size_t k = begin; k < end; ++k) {
    const T *p = rows + 4 * size_t{a_[k]}, *q = rows + 4 * size_t{b_[k]};
    const T dx = base_[3 * k] + (q[0] - p[0]), dy = base_[3 * k + 1] + (q[1] - p[1]),
            dz = base_[3 * k + 2] + (q[2] - p[2]);
    const T l2 = dx * dx + dy * dy + dz * dz, length = std::sqrt(l2), per_l = l2 > 0 ? 1 / length : T(0);
    const T alpha = compliance_[k] * per.h2, lambda = lambda_[k], weight = p[3] + q[3];
    const T bound = p[3] * links_a_[k] + q[3] * links_b_[k] + alpha;
    const T step = weight > 0 ? (rest_[k] - length - alpha * lambda) / bound : T(0);
    const T next = omega * (lambda + step - before_[k]) + before_[k];
    before_[k] = lambda, lambda_[k] = next;
    pull_[3 * k] = step * per_l * dx, pull_[3 * k + 1] = step * per_l * dy,
              pull_[3 * k + 2] = step * per_l * dz;
    tension_[k] = -next * per_l;
  }
}

template <class T>
T JacobiLinks<T>::iterate(const PerStep<T>& per, T omega, T relax, T* rows, const ThreadArena& arena) {
  if (a_.empty()) return 0;
  arena.for_blocks(a_.size(), kBlockRows,
                   [&](size_t begin, size_t end) { solve_links(per, omega, rows, begin, end); });
  arena.for_blocks(points_, kBlockRows, [&](size_t begin, size_t end) {
    T most = 0;
    for (size_t i = begin; i < end; ++i) {
      T* row = rows + 4 * i;
      T sum[3] = {}, tension = 0;
      for (uint32_t e = begin_[i]; e < begin_[i + 1]; ++e) {
        const size_t k = at_[e] / 2;
        const T sign = at_[e] % 2 ? T(1) : T(-1);
        for (size_t c = 0; c < 3; ++c) sum[c] += sign * pull_[3 * k + c];
        tension += tension_[k];
      }
      for (size_t c = 0; c < 3; ++c) {
        // The first iteration, with omega = 1, ignores the old values.
        const T here = row[c], old = omega == T(1) ? here : old_[3 * i + c];
        row[c] = omega * (here + relax * row[3] * sum[c] - old) + old;
        old_[3 * i + c] = here;
      }
      most = std::max(most, row[3] * tension);
    }
    q_[begin / kBlockRows] = most;
  });
  return *std::max_element(q_.begin(), q_.end());
}

template class JacobiLinks<float>;
template class JacobiLinks<double>;

}  // namespace truestep::xpbd
