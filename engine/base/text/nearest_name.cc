#include "engine/base/text/nearest_name.h"

#include <algorithm>
#include <vector>

#include "engine/base/text/other_words.h"

namespace truestep {

namespace {

// Optimal string alignment: Levenshtein distance with transpositions of neighbours.
size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    before.swap(last);
    last.swap(row);
  }
  return last.back();
}

}  // namespace

std::string nearest_name(std::string_view name, std::span<const std::string> names) {
  if (name.size() > 64) return "";
  for (const std::string_view said : names_for(name)) {
    if (const auto it = std::find(names.begin(), names.end(), said); it != names.end()) return *it;
  }
  std::string best;
  size_t best_distance = SIZE_MAX;
  for (const std::string& n : names) {
    const size_t longer = std::max(name.size(), n.size()), near = std::max<size_t>(1, longer / 3);
    const size_t d = edit_distance(name, n);
    // As many edits as letters: the two have nothing in common.
    if (d <= near && d < longer && d < best_distance) best = n, best_distance = d;
  }
  constexpr size_t kTelling = 3;
  if (!best.empty() || name.size() < kTelling) return best;
  for (const std::string& n : names) {
    if ((n.starts_with(name) || n.ends_with(name)) && (best.empty() || n.size() < best.size())) best = n;
  }
  return best;
}

}  // namespace truestep
