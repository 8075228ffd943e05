// The bodies that couplings hand to media for a substep, grouped by medium.
#pragma once
#include <span>
#include <vector>

#include "engine/core/ports/medium.h"

namespace truestep {

class Immersed {
 public:
  /// append(coupling, list) -> the system that the coupling's bodies are in.
  template <class Append>
  void gather(size_t systems, size_t couplings, const Append& append) {
    of_.resize(systems), parts_.resize(couplings);
    for (auto& list : of_) list.clear();
    for (size_t c = 0; c < couplings; ++c) {
      from_one_.clear();
      const size_t system = append(c, from_one_);
      parts_[c] = {system, of_[system].size(), from_one_.size()};
      of_[system].insert(of_[system].end(), from_one_.begin(), from_one_.end());
    }
  }
  std::span<ImmersedBody> of(size_t system) { return of_[system]; }
  std::span<const ImmersedBody> by(size_t coupling) const {
    const Part& p = parts_[coupling];
    return std::span<const ImmersedBody>(of_[p.system]).subspan(p.first, p.count);
  }

 private:
  struct Part {
    size_t system = 0, first = 0, count = 0;
  };
  std::vector<std::vector<ImmersedBody>> of_;
  std::vector<Part> parts_;
  std::vector<ImmersedBody> from_one_;
};

}  // namespace truestep
