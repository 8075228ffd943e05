#include "engine/math/solvers/reordering.h"

#include <algorithm>

namespace truestep {

namespace {

// Neighbours of every node in A + A^T, without the diagonal, ascending.
struct Graph {
  std::vector<int32_t> start, neighbours;
  int32_t degree(int32_t i) const { return start[size_t(i) + 1] - start[size_t(i)]; }
  std::span<const int32_t> of(int32_t i) const {
    return {neighbours.data() + start[size_t(i)], size_t(degree(i))};
  }
};

Graph symmetric_graph(const ColumnPattern& a) {
  const size_t n = a.columns();
  std::vector<std::pair<int32_t, int32_t>> edges;
  edges.reserve(2 * a.rows.size());
  for (size_t j = 0; j < n; ++j) {
    for (int32_t k = a.start[j]; k < a.start[j + 1]; ++k) {
      const int32_t i = a.rows[size_t(k)];
      if (i == int32_t(j)) continue;
      edges.emplace_back(i, int32_t(j));
      edges.emplace_back(int32_t(j), i);
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  Graph g;
  g.start.assign(n + 1, 0);
  for (const auto& [i, j] : edges) {
    ++g.start[size_t(i) + 1];
    g.neighbours.push_back(j);
  }
  for (size_t i = 0; i < n; ++i) g.start[i + 1] += g.start[i];
  return g;
}

// Breadth-first from `root`, neighbours by ascending degree; appended to `order`.
void breadth_first(const Graph& g, int32_t root, std::vector<char>& seen, std::vector<int32_t>& order) {
  size_t head = order.size();
  order.push_back(root);
  seen[size_t(root)] = 1;
  for (; head < order.size(); ++head) {
    const size_t first = order.size();
    for (const int32_t j : g.of(order[head])) {
      if (seen[size_t(j)]) continue;
      seen[size_t(j)] = 1;
      order.push_back(j);
    }
    std::stable_sort(order.begin() + long(first), order.end(),
                     [&](int32_t a, int32_t b) { return g.degree(a) < g.degree(b); });
  }
}

// A peripheral node: the last one of repeated breadth-first searches (after George, Liu 1979).
int32_t outer_node(const Graph& g, int32_t root, size_t n) {
  for (int turn = 0; turn < 3; ++turn) {
    std::vector<char> seen(n, 0);
    std::vector<int32_t> order;
    breadth_first(g, root, seen, order);
    root = order.back();
  }
  return root;
}

}  // namespace

std::vector<int32_t> reverse_cuthill_mckee(const ColumnPattern& a) {
  const size_t n = a.columns();
  const Graph g = symmetric_graph(a);
  std::vector<char> seen(n, 0);
  std::vector<int32_t> order;
  order.reserve(n);
  for (size_t i = 0; i < n; ++i) {
    if (!seen[i]) breadth_first(g, outer_node(g, int32_t(i), n), seen, order);
  }
  std::reverse(order.begin(), order.end());
  return order;
}

Bandwidth bandwidth(const ColumnPattern& a, std::span<const int32_t> order) {
  const size_t n = a.columns();
  std::vector<int32_t> place(n);
  for (size_t k = 0; k < n; ++k) place[size_t(order[k])] = int32_t(k);
  Bandwidth b;
  for (size_t j = 0; j < n; ++j) {
    for (int32_t k = a.start[j]; k < a.start[j + 1]; ++k) {
      const int32_t below = place[size_t(a.rows[size_t(k)])] - place[j];
      if (below > 0) b.lower = std::max(b.lower, size_t(below));
      if (below < 0) b.upper = std::max(b.upper, size_t(-below));
    }
  }
  return b;
}

ColumnGroups group_columns(const ColumnPattern& a) {
  const size_t n = a.columns();
  // Columns of every row, to find the columns that share a row.
  std::vector<int32_t> row_start(n + 1, 0), columns(a.rows.size());
  for (const int32_t i : a.rows) ++row_start[size_t(i) + 1];
  for (size_t i = 0; i < n; ++i) row_start[i + 1] += row_start[i];
  std::vector<int32_t> next(row_start.begin(), row_start.end() - 1);
  for (size_t j = 0; j < n; ++j) {
    for (int32_t k = a.start[j]; k < a.start[j + 1]; ++k) {
      columns[size_t(next[size_t(a.rows[size_t(k)])]++)] = int32_t(j);
    }
  }
  ColumnGroups result;
  result.group.assign(n, -1);
  std::vector<int32_t> taken_by;  // per group: the last column that may not use it
  for (size_t j = 0; j < n; ++j) {
    for (int32_t k = a.start[j]; k < a.start[j + 1]; ++k) {
      const auto i = size_t(a.rows[size_t(k)]);
      for (int32_t m = row_start[i]; m < row_start[i + 1]; ++m) {
        const int32_t g = result.group[size_t(columns[size_t(m)])];
        if (g >= 0) taken_by[size_t(g)] = int32_t(j);
      }
    }
    int32_t g = 0;
    while (g < result.groups && taken_by[size_t(g)] == int32_t(j)) ++g;
    if (g == result.groups) ++result.groups, taken_by.push_back(-1);
    result.group[j] = g;
  }
  return result;
}

}  // namespace truestep
