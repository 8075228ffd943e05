// Order conditions from rooted trees. For y' = f(y) a tree is a root with subtrees t_j; along the exact
// solution its elementary weight grows as C theta^(rho - 1), C = prod C_j / rho_j, while stage i of a method
// has Phi_i = prod_j sum_l a_il Phi_l(t_j); order p demands sum_i b_i Phi_i = C / rho of all trees of rho <=
// p nodes (Hairer, Norsett, Wanner 1993, theorem II.2.13). For y'' = f(y) a root has m leaves (powers of c_i)
// and subtrees two integrations away: rho = 1 + m + sum (rho_j + 1), C = prod C_j / (rho_j (rho_j + 1)),
// Phi_i = c_i^m prod_j sum_l a_il Phi_l(t_j); sum b'_i Phi_i = C / rho for rho <= p and sum b_i Phi_i =
// C / (rho (rho + 1)) for rho <= p - 1 (theorem II.14.3 with the condition on velocity left out of the
// trees).
#pragma once
#include <cstddef>
#include <vector>

namespace truestep::test {

struct RootedTree {
  size_t order = 1;
  size_t leaves = 0;             ///< second-order equations only
  std::vector<size_t> subtrees;  ///< places in the list, ascending
};

namespace detail {
template <class Add>
void grow(std::vector<RootedTree>& all, RootedTree root, size_t from, size_t left, size_t extra,
          const Add& add) {
  if (left == 0) return add(root);
  for (size_t i = from; i < all.size() && all[i].order + extra <= left; ++i) {
    RootedTree next = root;
    next.subtrees.push_back(i);
    grow(all, next, i, left - all[i].order - extra, extra, add);
  }
}
}  // namespace detail

/// All trees for y' = f(y) with up to `order` nodes, small ones first: 1, 1, 2, 4, 9, 20, 48, 115 ...
inline std::vector<RootedTree> first_order_trees(size_t order) {
  std::vector<RootedTree> all;
  for (size_t n = 1; n <= order; ++n) {
    std::vector<RootedTree> found;
    detail::grow(all, {.order = n}, 0, n - 1, 0, [&](const RootedTree& t) { found.push_back(t); });
    all.insert(all.end(), found.begin(), found.end());
  }
  return all;
}

/// All trees for y'' = f(y) up to `order`.
inline std::vector<RootedTree> second_order_trees(size_t order) {
  std::vector<RootedTree> all;
  for (size_t n = 1; n <= order; ++n) {
    std::vector<RootedTree> found;
    for (size_t leaves = 0; leaves < n; ++leaves) {
      detail::grow(all, {.order = n, .leaves = leaves}, 0, n - 1 - leaves, 1,
                   [&](const RootedTree& t) { found.push_back(t); });
    }
    all.insert(all.end(), found.begin(), found.end());
  }
  return all;
}

/// Elementary weights of every tree: exact factors C and the method's Phi_i. a(i, l), c(i) are the method's.
struct ElementaryWeights {
  std::vector<double> exact;
  std::vector<std::vector<double>> stages;
};
template <class A, class C>
ElementaryWeights elementary_weights(const std::vector<RootedTree>& trees, size_t stages, const A& a,
                                     const C& c, int integrations) {
  ElementaryWeights w;
  for (const RootedTree& t : trees) {
    double exact = 1;
    std::vector<double> phi(stages, 1.0);
    for (size_t leaf = 0; leaf < t.leaves; ++leaf) {
      for (size_t i = 0; i < stages; ++i) phi[i] *= c(i);
    }
    for (const size_t s : t.subtrees) {
      const auto rho = static_cast<double>(trees[s].order);
      exact *= w.exact[s] / (integrations == 1 ? rho : rho * (rho + 1));
      for (size_t i = 0; i < stages; ++i) {
        double sum = 0;
        for (size_t l = 0; l < stages; ++l) sum += a(i, l) * w.stages[s][l];
        phi[i] *= sum;
      }
    }
    w.exact.push_back(exact);
    w.stages.push_back(phi);
  }
  return w;
}

}  // namespace truestep::test
