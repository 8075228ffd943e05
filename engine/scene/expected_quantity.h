// What an expectation measures: an expression over observables, in which what a run did with them is written
// as functions.
//   energy.total                           the value at the end
//   max(rope.strain.max)                   min, max, mean, start; largest: max |x|; change: max |x - start|;
//                                          drift: change divided by a scale (session/expectation.h)
//   largest(x, 8, 10) / largest(x, 0, 2)   of a part of the run: from, until (s)
//   max(tip.position.y) - start(top.y)     arithmetic and functions as in equations, `t` = time in s
//   largest(tip.position.x - cos(2*t))     reductions take expressions, too, except drift
//   energy.gain, energy.loss               the most that energy.total rises above, or falls below, its start,
//                                          divided by the energy at work: kinetic at the start + the most
//                                          that energy.potential has fallen + `given`
// min and max of two values are the usual functions. An observable whose name has a hyphen stands alone.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/core/observables.h"
#include "engine/math/expression/graph.h"
#include "engine/math/expression/program.h"

namespace truestep {

/// How a run's values are reduced to one.
enum class Reduction : uint8_t { last, start, min, max, mean, largest, change, drift, gain, loss };

/// A value at one moment: one observable, or an expression over several and the time.
class QuantityTerm {
 public:
  /// Throws ExpressionFault.
  explicit QuantityTerm(const std::string& text);
  const std::vector<std::string>& names() const { return names_; }
  bool plain() const { return !program_; }
  /// Empty when an observable is missing.
  std::optional<double> value(const Observables& values, double t) const;

 private:
  std::vector<std::string> names_;
  std::optional<ExpressionProgram> program_;  ///< of the names in order, and t
};

/// A term reduced over the run, or over a part of it (s).
struct QuantityTrack {
  Reduction reduction;
  QuantityTerm term;
  std::optional<double> from, until;
};

class ExpectedQuantity {
 public:
  /// Throws ExpressionFault.
  explicit ExpectedQuantity(const std::string& text);
  const std::vector<QuantityTrack>& tracks() const { return tracks_; }
  /// The reduction, if the quantity is nothing but one.
  std::optional<Reduction> only() const;
  /// The value at the end from those of the tracks, in order; t is the time at the end.
  double combine(const std::vector<double>& tracks, double t) const;

 private:
  void read(const std::string& text);

  std::vector<QuantityTrack> tracks_;
  std::optional<ExpressionProgram> program_;  ///< of the tracks in order, and t; empty: the only track
};

}  // namespace truestep
