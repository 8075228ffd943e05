#include "engine/systems/molecular/topology.h"

#include <algorithm>

namespace truestep::molecular {

std::vector<std::array<uint32_t, 2>> excluded_pairs(const MolecularDef& def, const Atoms& atoms) {
  std::vector<std::array<uint32_t, 2>> out;
  const auto add = [&](int64_t i, int64_t j) {
    if (i != j) out.push_back({static_cast<uint32_t>(std::min(i, j)), static_cast<uint32_t>(std::max(i, j))});
  };
  std::vector<std::vector<int64_t>> bonded(def.bonds.empty() ? 0 : atoms.size());
  for (const BondDef& b : def.bonds) {
    bonded[static_cast<size_t>(b.a)].push_back(b.b), bonded[static_cast<size_t>(b.b)].push_back(b.a);
  }
  for (size_t i = 0; i < bonded.size(); ++i) {
    for (const int64_t j : bonded[i]) {
      add(static_cast<int64_t>(i), j);
      for (const int64_t k : bonded[i]) add(j, k);
    }
  }
  for (const AngleDef& a : def.angles) add(a.a, a.b), add(a.b, a.c), add(a.a, a.c);
  for (const auto& w : atoms.waters) add(w[0], w[1]), add(w[0], w[2]), add(w[1], w[2]);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

Exclusions exclusions(const std::vector<std::array<uint32_t, 2>>& pairs, size_t atoms) {
  Exclusions out;
  out.begin.assign(atoms + 1, 0);
  for (const auto& [i, j] : pairs) ++out.begin[i + 1], ++out.begin[j + 1];
  for (size_t i = 0; i < atoms; ++i) out.begin[i + 1] += out.begin[i];
  out.partners.resize(2 * pairs.size());
  std::vector<uint32_t> next(out.begin.begin(), out.begin.end() - 1);
  for (const auto& [i, j] : pairs) out.partners[next[i]++] = j, out.partners[next[j]++] = i;
  return out;
}

void check_topology(const MolecularDef& def, size_t atoms, const DefTable::Report& report) {
  const auto check = [&](const std::string& pointer, std::initializer_list<int64_t> rows) {
    for (const int64_t r : rows) {
      if (static_cast<size_t>(r) >= atoms) {
        return report(pointer, "there is no atom " + std::to_string(r) + ", only " + std::to_string(atoms));
      }
      if (std::count(rows.begin(), rows.end(), r) > 1) return report(pointer, "its atoms differ");
    }
  };
  const auto each = [&](const auto& list, const std::string& name, const auto& rows) {
    for (size_t k = 0; k < list.size(); ++k) rows(list[k], "/" + name + "/" + std::to_string(k));
  };
  each(def.bonds, "bonds", [&](const BondDef& b, const std::string& at) { check(at, {b.a, b.b}); });
  each(def.angles, "angles", [&](const AngleDef& b, const std::string& at) { check(at, {b.a, b.b, b.c}); });
  each(def.dihedrals, "dihedrals", [&](const DihedralDef& b, const std::string& at) {
    check(at, {b.a, b.b, b.c, b.d});
  });
}

}  // namespace truestep::molecular
