// Numbers about a state that a scientist plots: energies, momenta, residuals, counts.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace truestep {

struct Observation {
  std::string name;  ///< dotted, e.g. "energy.kinetic"
  double value = 0;
  std::string unit;  ///< SI
};

/// Whether an observable, by its dotted name, is asked for; an empty one asks for all.
using WantedObservables = std::function<bool(std::string_view)>;

class Observables {
 public:
  Observables() = default;
  explicit Observables(WantedObservables wanted) : wanted_(std::move(wanted)) {}
  /// Others may be left out: those that take a pass of their own should be.
  bool wants(std::string_view name) const { return !wanted_ || wanted_(name); }
  void add(std::string_view name, double value, std::string_view unit);
  const std::vector<Observation>& rows() const { return rows_; }
  std::optional<double> find(std::string_view name) const;

 private:
  WantedObservables wanted_;
  std::vector<Observation> rows_;
};

}  // namespace truestep
