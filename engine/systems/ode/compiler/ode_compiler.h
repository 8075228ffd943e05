// One pass over a scene's texts with the states in a given order: names, definitions, equations, events,
// plot, programs. Faults are collected and reported together.
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/text/json_pointer.h"
#include "engine/math/expression/names.h"
#include "engine/systems/ode/ode_model.h"

namespace truestep::ode {

class OdeCompiler {
 public:
  /// order[k]: index of the k-th declared state; empty: as declared. `sides`: number of signs of states that
  /// become parameters.
  OdeCompiler(const OdeDef& def, std::vector<uint32_t> order, size_t sides = 0)
      : def_(def), order_(std::move(order)), switched_(sides) {}

  /// Throws Error "scene_invalid" with all faults. Call once.
  OdeModel compile();

  /// After compile: indices of the declared states, positions first, then velocities in the same order; empty
  /// when the equations do not pair up.
  const std::vector<uint32_t>& paired() const { return paired_; }
  /// After compile without sides: how many there are; with them: 0 if the signs must stay as they are.
  size_t sides() const { return sides_; }

 private:
  using Node = ExpressionGraph::Node;
  using EachUse = std::function<void(uint32_t place, const ExpressionNames::Bindings&)>;

  // --- ode_compiler.cc

  void fault(const std::string& pointer, const ExpressionFault& f, std::string_view text);
  void issue(const std::string& pointer, const char* code, const std::string& message,
             std::string_view value = "", const std::string& allowed = "",
             const std::string& did_you_mean = "");
  /// The node of a text, or of 0 if it is faulty.
  Node read(const std::string& pointer, const std::string& text,
            const ExpressionNames::Bindings& bindings = {});
  const OdeModel::Named* named(const std::vector<OdeModel::Named>& list, std::string_view name) const;
  /// Calls use(index, bindings) for every element named by the left-hand side "x", "x[i]" or "x[3]".
  void each_element(const std::string& pointer, const std::string& left, const OdeModel::Named& n,
                    const ExpressionTarget& target, const EachUse& use);

  // --- ode_compiler_names.cc

  void declare();
  void add_name(const std::string& pointer, const OdeModel::Named& named, int32_t first);
  static std::string base_name(const std::string& target);
  void add_state(const std::string& pointer, const NamedNumbers& s);
  void add_velocity(const std::string& target);
  void definitions();

  // --- ode_compiler_equations.cc

  void equations();
  void equation(const std::string& list, const NamedText& e, const std::string& suffix);

  // --- ode_compiler_events.cc

  void rest();
  void event(size_t k);
  void tracers();

  // --- ode_compiler_plot.cc, ode_compiler_axes.cc

  void plot();
  /// What the k-th axis shows, and where.
  PlotAxis axis(size_t k, const std::string& text) const;
  std::vector<ExpressionProgram::Node> along(size_t k) const;
  /// Name of a state's or parameter's element, with its index or without; "t" for time.
  enum class Index : uint8_t { with, without };
  std::string name_of(int32_t variable, Index index) const;
  bool is_parameter(int32_t variable) const { return variable > 0 && variable < first_state_; }
  std::vector<std::string> curves() const;
  /// Number of points of an axis: the length of the array that it names, or of the longest when it uses [i];
  /// 0: any number.
  size_t elements(const std::string& axis) const;
  /// The first two or three arrays of equal length, or the first two or three numbers; velocities come last.
  std::vector<std::string> default_axes() const;
  bool is_velocity(const std::string& name) const;
  Node graph_of_variable(uint32_t place) const;

  // --- ode_compiler_programs.cc

  ExpressionProgram program(const std::vector<Node>& roots) const;
  void programs();
  Node rate_of(Node n);
  /// Derives from each event's guard and its first two rates the contact with the states that the event sets.
  void contacts();
  /// Finds the comparisons of time in the equations.
  void stops();
  /// How the changes of sign of an expression of time are found; see OdeModel::Stop.
  OdeModel::Stop kind_of_stop(Node n, Node slope) const;
  // --- ode_compiler_slides.cc

  /// The signs in the equations whose expressions depend on states.
  void find_signs();
  /// The roots with sides in place of these signs.
  std::vector<Node> with_sides(const std::vector<Node>& roots);
  /// Compiles what decides about slides; false where the equations are not linear in the sides.
  bool slides();

  /// Finds P and V such that x' = v for x in P, v in V, one to one, and P and V together are all states.
  void pair_up();
  /// Derivatives of the roots with respect to `blocks` groups of n states, all of the same shape.
  void differentiate(const std::vector<Node>& roots, int32_t n, int32_t blocks, OdeMatrix& out);

  const OdeDef& def_;
  std::vector<uint32_t> order_, paired_;
  ExpressionGraph graph_;
  ExpressionNames names_;
  OdeModel model_;
  std::vector<Issue> issues_;
  int32_t first_state_ = 1;
  std::vector<Node> roots_, invariants_, guards_, plot_, tracer_roots_, signs_, slide_guards_;
  size_t switched_ = 0, sides_ = 0;
  std::vector<std::vector<Node>> event_values_;
};

}  // namespace truestep::ode
