// Analysis of the pattern of a sparse square matrix, before any number is known: an order of the unknowns
// that brings the entries close to the diagonal (reverse Cuthill-McKee: Cuthill, McKee 1969; George 1971),
// and groups of columns that share no row, which one difference quotient can measure together (Curtis,
// Powell, Reid 1974). Patterns are compressed columns; both results depend on the pattern alone.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace truestep {

/// Compressed columns: rows[start[j] ... start[j + 1]) are the rows of column j, ascending.
struct ColumnPattern {
  std::span<const int32_t> start;
  std::span<const int32_t> rows;
  size_t columns() const { return start.empty() ? 0 : start.size() - 1; }
};

/// order[new] = old, from the pattern of A + A^T.
std::vector<int32_t> reverse_cuthill_mckee(const ColumnPattern& a);

struct Bandwidth {
  size_t lower = 0, upper = 0;
};
/// Diagonals in use when unknown order[k] is renumbered k.
Bandwidth bandwidth(const ColumnPattern& a, std::span<const int32_t> order);

/// Group of every column, 0 ... groups - 1, greedily in the order of the columns.
struct ColumnGroups {
  std::vector<int32_t> group;
  int32_t groups = 0;
};
ColumnGroups group_columns(const ColumnPattern& a);

}  // namespace truestep
