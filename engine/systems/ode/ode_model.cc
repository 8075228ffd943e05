#include "engine/systems/ode/ode_model.h"

#include <algorithm>
#include <charconv>
#include <numeric>

#include "engine/base/nearest_name.h"
#include "engine/math/expression/names.h"

namespace truestep {

namespace {

using Node = ExpressionGraph::Node;
using Target = OdeModel::Event::Target;

constexpr size_t kMaxStates = 20'000, kMaxTracerVariables = 250;

std::string token(std::string_view key) {
  std::string out;
  for (const char c : key) out += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return out;
}

/// One pass over a scene's texts with the states in a given order.
class Compiler {
 public:
  /// order[k]: place of the k-th declared state; empty: as declared.
  Compiler(const OdeDef& def, std::vector<uint32_t> order) : def_(def), order_(std::move(order)) {}

  OdeModel compile() {
    declare();
    definitions();
    equations();
    rest();
    tracers();
    if (!issues_.empty()) {
      const std::string first = issues_[0].pointer + ": " + issues_[0].message;
      throw Error("scene_invalid", first, std::move(issues_));
    }
    programs();
    return std::move(model_);
  }

  /// After compile: positions, then velocities in the same order, as places of the declared states; empty
  /// when the equations do not pair up.
  const std::vector<uint32_t>& paired() const { return paired_; }

 private:
  void fault(const std::string& pointer, const ExpressionFault& f, std::string_view text) {
    issue(pointer, "bad_expression", describe(f, text), text, "", f.did_you_mean);
  }
  void issue(const std::string& pointer, const char* code, const std::string& message,
             std::string_view value = "", const std::string& allowed = "",
             const std::string& did_you_mean = "") {
    if (issues_.size() >= 100) return;
    std::string shown;
    for (const char c : value.substr(0, 80)) shown += c >= ' ' && c <= '~' && c != '"' && c != '\\' ? c : '?';
    issues_.push_back(
        {pointer, code, message, value.empty() ? "" : '"' + shown + '"', allowed, did_you_mean, ""});
  }
  /// The node of a text, or of 0 when it is faulty.
  Node read(const std::string& pointer, const std::string& text,
            const ExpressionNames::Bindings& bindings = {}) {
    try {
      return names_.require(graph_, text, bindings);
    } catch (const ExpressionFault& f) {
      fault(pointer, f, text);
      return graph_.constant(0);
    }
  }

  // --- names

  void add_name(const std::string& pointer, const OdeModel::Named& named, int32_t first) {
    std::vector<Node> nodes;
    for (const uint32_t place : named.places)
      nodes.push_back(graph_.variable(first + static_cast<int32_t>(place)));
    const bool added = named.form == NamedNumbers::Form::number
                           ? names_.add_value(named.name, nodes[0])
                           : names_.add_array(named.name, std::move(nodes));
    if (!added) {
      issue(pointer, "bad_name", "this name is taken, reserved or no name", named.name,
            "letters, digits, _; not t, pi, sum, len or a function");
    }
  }
  void declare() {
    names_.add_value("t", graph_.variable(0));
    for (const NamedNumbers& p : def_.parameters) {
      OdeModel::Named named{p.name, {}, p.form};
      for (const double v : p.values) {
        named.places.push_back(static_cast<uint32_t>(model_.parameter_values.size()));
        model_.parameter_values.push_back(v);
      }
      add_name("/parameters/" + token(p.name), named, 1);
      model_.parameters.push_back(std::move(named));
    }
    first_state_ = static_cast<int32_t>(1 + model_.parameter_values.size());
    for (const NamedNumbers& s : def_.states) add_state("/states/" + token(s.name), s);
    for (const NamedText& e : def_.second) add_velocity(e.name);
    for (const NamedNumbers& v : def_.velocities) {
      const auto same = [&](const NamedText& e) { return base_name(e.name) == v.name; };
      if (std::none_of(def_.second.begin(), def_.second.end(), same)) {
        issue("/velocities/" + token(v.name), "unknown_name", "no equation of second order is given for it",
              v.name);
      }
    }
    if (!order_.empty()) {
      std::vector<double> values(model_.initial.size());
      std::vector<std::string> labels(values.size());
      for (size_t d = 0; d < values.size(); ++d) {
        values[order_[d]] = model_.initial[d];
        labels[order_[d]] = model_.labels[d];
      }
      model_.initial = std::move(values);
      model_.labels = std::move(labels);
    }
  }
  static std::string base_name(const std::string& target) {
    return target.substr(0, target.find_first_of("[ "));
  }
  void add_state(const std::string& pointer, const NamedNumbers& s) {
    if (model_.initial.size() + s.values.size() > kMaxStates) {
      return issue(pointer, "too_many", "too many states", "", "at most " + std::to_string(kMaxStates));
    }
    if (s.name == "position")
      issue(pointer, "bad_name", "\"position\" is what is drawn; name the state otherwise");
    OdeModel::Named named{s.name, {}, s.form};
    for (size_t k = 0; k < s.values.size(); ++k) {
      const auto declared = static_cast<uint32_t>(model_.initial.size());
      named.places.push_back(order_.empty() ? declared : order_[declared]);
      model_.labels.push_back(s.form == NamedNumbers::Form::number ? s.name
                                                                   : s.name + "[" + std::to_string(k) + "]");
      model_.initial.push_back(s.values[k]);
    }
    add_name(pointer, named, first_state_);
    model_.states.push_back(std::move(named));
  }
  void add_velocity(const std::string& target) {
    const std::string name = base_name(target);
    const auto same = [&](const auto& e) { return e.name == name; };
    const auto state = std::find_if(def_.states.begin(), def_.states.end(), same);
    const auto taken = std::find_if(model_.states.begin(), model_.states.end(),
                                    [&](const OdeModel::Named& s) { return s.name == name + "'"; });
    if (state == def_.states.end() || taken != model_.states.end()) return;  // reported with the equation
    NamedNumbers v{name + "'", std::vector<double>(state->values.size(), 0.0), state->form};
    const auto given = std::find_if(def_.velocities.begin(), def_.velocities.end(), same);
    if (given != def_.velocities.end()) {
      if (given->values.size() != v.values.size()) {
        issue("/velocities/" + token(name), "inconsistent",
              "needs as many numbers as the state has: " + std::to_string(v.values.size()));
      } else {
        v.values = given->values;
      }
    }
    add_state("/second/" + token(target), v);
  }

  void definitions() {
    for (const NamedText& e : def_.let) {
      const std::string pointer = "/let/" + token(e.name);
      try {
        const ExpressionTarget target = parse_expression_target(e.name);
        bool added;
        if (target.indices.empty()) {
          added = names_.add_value(target.name, read(pointer, e.text));
        } else {
          ExpressionNames::Bindings zero;
          for (const std::string& i : target.indices) {
            if (!good_expression_name(i))
              throw ExpressionFault{0, "the indices of a definition are names", ""};
            zero.emplace_back(i, 0);
          }
          try {
            names_.read(graph_, e.text, zero);
          } catch (const ExpressionFault& f) {
            fault(pointer, f, e.text);
          }
          added = names_.add_definition(target.name, target.indices, e.text);
        }
        if (!added) issue(pointer, "bad_name", "this name is taken, reserved or no name", target.name);
      } catch (const ExpressionFault& f) {
        fault(pointer, f, e.name);
      }
    }
  }

  // --- equations

  const OdeModel::Named* named(const std::vector<OdeModel::Named>& list, std::string_view name) const {
    for (const OdeModel::Named& n : list) {
      if (n.name == name) return &n;
    }
    return nullptr;
  }
  /// Calls use(place, bindings) for every element that the left-hand side "x", "x[i]" or "x[3]" names.
  template <class Use>
  void each_element(const std::string& pointer, const std::string& left, const OdeModel::Named& n,
                    const ExpressionTarget& target, Use&& use) {
    const bool array = n.form == NamedNumbers::Form::array;
    if (target.indices.size() != (array ? 1u : 0u)) {
      return issue(pointer, "bad_target",
                   array ? "\"" + n.name + "\" is an array: write " + n.name + "[i]"
                         : "\"" + n.name + "\" is one number and takes no index",
                   left);
    }
    if (!array) return use(n.places[0], ExpressionNames::Bindings{});
    const std::string& i = target.indices[0];
    if (i[0] < '0' || i[0] > '9') {
      if (!good_expression_name(i)) return issue(pointer, "bad_target", "this is no name for an index", i);
      for (size_t k = 0; k < n.places.size(); ++k) {
        use(n.places[k], ExpressionNames::Bindings{{i, static_cast<int64_t>(k)}});
      }
      return;
    }
    size_t k = 0;
    std::from_chars(i.data(), i.data() + i.size(), k);
    if (k >= n.places.size()) {
      return issue(pointer, "bad_target", "indices run from 0 to " + std::to_string(n.places.size() - 1),
                   left);
    }
    use(n.places[k], ExpressionNames::Bindings{});
  }
  void equations() {
    roots_.assign(model_.size(), ExpressionGraph::kNone);
    for (const NamedText& e : def_.equations) equation("/equations/", e, "");
    for (const NamedText& e : def_.second) equation("/second/", e, "'");
    // x' = v for the equations of second order.
    for (const NamedText& e : def_.second) {
      const auto *x = named(model_.states, base_name(e.name)),
                 *v = named(model_.states, base_name(e.name) + "'");
      if (!x || !v) continue;
      for (size_t k = 0; k < x->places.size(); ++k) {
        Node& root = roots_[x->places[k]];
        const Node node = graph_.variable(first_state_ + static_cast<int32_t>(v->places[k]));
        if (root != ExpressionGraph::kNone && root != node) {
          issue("/second/" + token(e.name), "duplicate", "this state has an equation of first order too",
                e.name);
        }
        root = node;
      }
    }
    std::string missing;
    for (size_t k = 0; k < roots_.size(); ++k) {
      if (roots_[k] != ExpressionGraph::kNone) continue;
      if (missing.size() < 200) missing += (missing.empty() ? "" : ", ") + model_.labels[k];
      roots_[k] = graph_.constant(0);
    }
    if (!missing.empty()) issue("/equations", "missing", "no equation says how these change: " + missing);
  }
  void equation(const std::string& list, const NamedText& e, const std::string& suffix) {
    const std::string pointer = list + token(e.name);
    try {
      const ExpressionTarget target = parse_expression_target(e.name);
      const OdeModel::Named* n = named(model_.states, target.name + suffix);
      if (!n) {
        std::vector<std::string> known;
        std::string all;
        for (const NamedNumbers& s : def_.states) {
          known.push_back(s.name);
          if (all.size() < 200) all += (all.empty() ? "" : ", ") + s.name;
        }
        return issue(pointer, "unknown_name", "no state has this name", target.name, all,
                     nearest_name(target.name, known));
      }
      bool good = true;
      each_element(pointer, e.name, *n, target,
                   [&](uint32_t place, const ExpressionNames::Bindings& bindings) {
                     if (!good) return;
                     const size_t before = issues_.size();
                     const Node node = read(pointer, e.text, bindings);
                     if (roots_[place] != ExpressionGraph::kNone) {
                       issue(pointer, "duplicate", model_.labels[place] + " has another equation", e.name);
                     }
                     roots_[place] = node;
                     good = issues_.size() == before;  // one fault for a whole family
                   });
    } catch (const ExpressionFault& f) {
      fault(pointer, f, e.name);
    }
  }

  // --- events, invariants, drawing

  void rest() {
    for (const NamedText& e : def_.invariants) {
      if (!good_expression_name(e.name))
        issue("/invariants/" + token(e.name), "bad_name", "this is no name", e.name);
      model_.invariant_names.push_back(e.name);
      invariants_.push_back(read("/invariants/" + token(e.name), e.text));
    }
    for (size_t k = 0; k < def_.events.size(); ++k) event(k);
    plot();
    for (const NamedNumbers& a : def_.absolute_tolerances) {
      const std::string pointer = "/absolute_tolerances/" + token(a.name);
      const OdeModel::Named* n = named(model_.states, a.name);
      if (!n) {
        issue(pointer, "unknown_name", "no state has this name", a.name);
      } else if (a.values.size() != 1 && a.values.size() != n->places.size()) {
        issue(pointer, "inconsistent", "needs one number, or one per element of the state");
      } else {
        const double otherwise = def_.absolute_tolerance.value_or(def_.tolerance.value_or(kOdeTolerance));
        model_.absolute_tolerances.resize(model_.size(), otherwise);
        for (size_t i = 0; i < n->places.size(); ++i) {
          model_.absolute_tolerances[n->places[i]] = a.values[a.values.size() == 1 ? 0 : i];
        }
      }
    }
  }
  void event(size_t k) {
    const OdeEventDef& d = def_.events[k];
    const std::string pointer = "/events/" + std::to_string(k);
    OdeModel::Event e{d.name.empty() ? std::to_string(k) : d.name, d, {}, {}, guards_.size()};
    if (!d.name.empty() && !good_expression_name(d.name)) {
      issue(pointer + "/name", "bad_name", "letters, digits and _, a letter first", d.name);
    }
    if (!d.when.empty()) guards_.push_back(read(pointer + "/when", d.when));
    std::vector<Node> values;
    for (const NamedText& s : d.set) {
      const std::string at = pointer + "/set/" + token(s.name);
      try {
        const ExpressionTarget target = parse_expression_target(s.name);
        const OdeModel::Named *state = named(model_.states, target.name),
                              *parameter = named(model_.parameters, target.name);
        if (!state && !parameter) {
          std::vector<std::string> known;
          for (const auto* list : {&model_.states, &model_.parameters}) {
            for (const OdeModel::Named& n : *list) known.push_back(n.name);
          }
          issue(at, "unknown_name", "no state and no parameter has this name", target.name, "",
                nearest_name(target.name, known));
          continue;
        }
        each_element(at, s.name, state ? *state : *parameter, target,
                     [&](uint32_t place, const ExpressionNames::Bindings& bindings) {
                       e.targets.push_back({state ? Target::Kind::state : Target::Kind::parameter, place});
                       values.push_back(read(at, s.text, bindings));
                     });
      } catch (const ExpressionFault& f) {
        fault(at, f, s.name);
      }
    }
    event_values_.push_back(std::move(values));
    model_.events.push_back(std::move(e));
  }
  void plot() {
    std::vector<std::string> axes = def_.plot;
    if (axes.empty()) axes = default_axes();
    model_.bodies = axes.empty() ? 0 : 1;
    for (size_t k = 0; k < axes.size(); ++k) {
      const size_t n = elements(axes[k]);
      if (n == 0) continue;
      if (model_.bodies != 1 && model_.bodies != n) {
        issue("/plot/" + std::to_string(k), "inconsistent", "arrays that are drawn together are equally long",
              axes[k]);
      }
      model_.bodies = std::max(model_.bodies, n);
    }
    for (size_t body = 0; body < model_.bodies; ++body) {
      for (size_t k = 0; k < 3; ++k) {
        Node node = graph_.constant(0);
        const OdeModel::Named* n = k < axes.size() ? named(model_.states, axes[k]) : nullptr;
        if (n && n->form == NamedNumbers::Form::array) {
          if (body < n->places.size()) {
            node = graph_.variable(first_state_ + static_cast<int32_t>(n->places[body]));
          }
        } else if (k < axes.size()) {
          const size_t before = issues_.size();
          node = read("/plot/" + std::to_string(k), axes[k], {{"i", static_cast<int64_t>(body)}});
          if (issues_.size() > before) axes[k] = "0";  // one fault for all points
        }
        plot_.push_back(node);
      }
    }
  }
  /// Points that an axis stands for: elements of the array that it names, or of the longest when it uses [i];
  /// 0: any number.
  size_t elements(const std::string& axis) const {
    if (const OdeModel::Named* n = named(model_.states, axis)) {
      return n->form == NamedNumbers::Form::array ? n->places.size() : 0;
    }
    size_t longest = 0;
    for (const OdeModel::Named& n : model_.states) {
      if (n.form == NamedNumbers::Form::array) longest = std::max(longest, n.places.size());
    }
    return axis.find("[i]") != std::string::npos ? longest : 0;
  }
  /// The first two or three arrays of equal length, or the first two or three numbers; velocities come last.
  std::vector<std::string> default_axes() const {
    std::vector<std::string> axes;
    if (model_.states.empty()) return axes;
    const auto form = model_.states[0].form;
    const size_t length = model_.states[0].places.size();
    const bool second = !def_.second.empty();
    const size_t positions = second ? def_.states.size() : model_.states.size();
    for (size_t k = 0; k < positions && axes.size() < 3; ++k) {
      const OdeModel::Named& s = model_.states[k];
      if (s.form == form && s.places.size() == length) axes.push_back(s.name);
    }
    // x, y, vx, vy and the like: the third is a velocity.
    if (!second && axes.size() == 3 && is_velocity(axes[2])) axes.pop_back();
    if (axes.size() == 1 && form == NamedNumbers::Form::number && model_.states.size() > 1) {
      axes.push_back(model_.states[1].name == axes[0] ? model_.states[0].name : model_.states.back().name);
    }
    return axes;
  }
  bool is_velocity(const std::string& name) const {
    const OdeModel::Named* n = named(model_.states, name);
    const Node v = graph_of_variable(n->places[0]);
    return std::find(roots_.begin(), roots_.end(), v) != roots_.end();
  }
  Node graph_of_variable(uint32_t place) const {
    for (size_t n = 0; n < graph_.size(); ++n) {
      const auto& e = graph_.at(static_cast<Node>(n));
      if (e.op == Operation::variable && e.a == first_state_ + static_cast<int32_t>(place))
        return static_cast<Node>(n);
    }
    return ExpressionGraph::kNone;
  }

  void tracers() {
    if (!def_.tracers) return;
    if (model_.variables() > kMaxTracerVariables) {
      issue("/tracers", "too_many",
            "a field for tracers depends on at most " + std::to_string(kMaxTracerVariables) +
                " parameters and states");
      return;
    }
    auto next = static_cast<int32_t>(model_.variables());
    for (const char* axis : {"x", "y", "z"}) {
      if (!names_.add_value(axis, graph_.variable(next++))) {
        issue("/tracers", "bad_name",
              "x, y and z are the tracers' own here; name states and parameters otherwise", axis);
      }
    }
    for (const char* axis : {"x", "y", "z"}) {
      const auto given = std::find_if(def_.tracers->velocity.begin(), def_.tracers->velocity.end(),
                                      [&](const NamedText& v) { return v.name == axis; });
      tracer_roots_.push_back(given == def_.tracers->velocity.end()
                                  ? graph_.constant(0)
                                  : read(std::string("/tracers/velocity/") + axis, given->text));
    }
  }

  // --- programs

  ExpressionProgram program(const std::vector<Node>& roots) const {
    return {graph_, roots, model_.variables()};
  }

  void programs() {
    OdeModel& m = model_;
    m.rate = program(roots_);
    m.invariants = program(invariants_);
    m.guards = program(guards_);
    m.plot = program(plot_);
    for (size_t k = 0; k < m.events.size(); ++k) m.events[k].values = program(event_values_[k]);
    const auto used = graph_.variables_of(roots_);
    m.autonomous = used.empty() || used[0] != 0;
    if (!tracer_roots_.empty()) {
      try {
        m.tracer_velocity = ExpressionRows(graph_, tracer_roots_);
      } catch (const ExpressionFault& f) {
        throw Error("scene_invalid", f.message,
                    {{"/tracers/velocity", "bad_expression", f.message, "", "", "", ""}});
      }
    }
    pair_up();
    const auto n = static_cast<int32_t>(m.size());
    m.second_order = !paired_.empty() && std::is_sorted(paired_.begin(), paired_.end());
    if (m.second_order) {
      const std::vector<Node> accelerations(roots_.begin() + n / 2, roots_.end());
      m.acceleration = program(accelerations);
      const auto on = graph_.variables_of(accelerations);
      m.depends_on_velocity = !on.empty() && on.back() >= first_state_ + n / 2;
      differentiate(accelerations, n / 2, 2, m.acceleration_jacobian);
    }
    differentiate(roots_, n, 1, m.jacobian);
  }

  /// Finds P and V such that x' = v for x in P, v in V, one to one, and P and V are all states.
  void pair_up() {
    const size_t n = model_.size();
    if (n == 0 || n % 2) return;
    std::vector<int32_t> velocity_of(n, -1);
    std::vector<uint8_t> is_velocity(n);
    // In the order of declaration, so that the order of the scene decides where several pairings exist.
    std::vector<uint32_t> declared(n);
    for (uint32_t d = 0; d < n; ++d) declared[d] = order_.empty() ? d : order_[d];
    size_t pairs = 0;
    for (const uint32_t p : declared) {
      const auto& e = graph_.at(roots_[p]);
      if (is_velocity[p] || e.op != Operation::variable || e.a < first_state_) continue;
      const auto v = static_cast<uint32_t>(e.a - first_state_);
      if (v == p || is_velocity[v] || velocity_of[v] >= 0) continue;
      velocity_of[p] = static_cast<int32_t>(v);
      is_velocity[v] = 1;
      ++pairs;
    }
    if (2 * pairs != n) return;
    paired_.resize(n);
    uint32_t next = 0;
    for (uint32_t d = 0; d < n; ++d) {
      const uint32_t p = declared[d];
      if (velocity_of[p] < 0) continue;
      const auto v = static_cast<uint32_t>(velocity_of[p]);
      const auto dv = static_cast<size_t>(std::find(declared.begin(), declared.end(), v) - declared.begin());
      paired_[d] = next;
      paired_[dv] = next + static_cast<uint32_t>(n / 2);
      ++next;
    }
    if (!order_.empty() && paired_ == order_) std::iota(paired_.begin(), paired_.end(), 0);
  }

  /// Derivatives of the roots by `blocks` groups of n states, all of one shape.
  void differentiate(const std::vector<Node>& roots, int32_t n, int32_t blocks, OdeMatrix& out) {
    std::vector<std::vector<ExpressionGraph::Partial>> rows(roots.size());
    try {
      for (size_t i = 0; i < roots.size(); ++i) {
        graph_.differentiate(roots[i], first_state_, n * blocks, rows[i]);
      }
    } catch (const ExpressionFault&) {
      return;  // too large: methods difference a dense matrix
    }
    std::vector<std::vector<int32_t>> pattern(static_cast<size_t>(n));  // rows of every column, ascending
    int32_t lower = 0, upper = 0;
    size_t count = 0;
    for (int32_t i = 0; i < n; ++i) {
      for (const auto& p : rows[static_cast<size_t>(i)]) {
        auto& column = pattern[static_cast<size_t>(p.variable % n)];
        if (!column.empty() && column.back() == i) continue;
        column.push_back(i);
        lower = std::max(lower, i - p.variable % n), upper = std::max(upper, p.variable % n - i);
        ++count;
      }
    }
    const auto width = static_cast<size_t>(lower + upper + 1), size = static_cast<size_t>(n);
    if (size > 12 && 3 * width <= size) {
      out.kind = MatrixShape::Kind::banded;
      out.lower = static_cast<size_t>(lower), out.upper = static_cast<size_t>(upper);
    } else if (size > 12 && 6 * count <= size * size) {
      out.kind = MatrixShape::Kind::sparse;
      out.column_start.push_back(0);
      for (const auto& column : pattern) {
        out.rows.insert(out.rows.end(), column.begin(), column.end());
        out.column_start.push_back(static_cast<int32_t>(out.rows.size()));
      }
    }
    const size_t values = out.shape().values(size);
    if (values * static_cast<size_t>(blocks) > 4'000'000) return;
    std::vector<Node> nodes(values * static_cast<size_t>(blocks), graph_.constant(0));
    for (int32_t i = 0; i < n; ++i) {
      for (const auto& p : rows[static_cast<size_t>(i)]) {
        const auto j = static_cast<size_t>(p.variable % n), row = static_cast<size_t>(i);
        size_t at = j * size + row;
        if (out.kind == MatrixShape::Kind::banded) at = j * width + out.upper + row - j;
        if (out.kind == MatrixShape::Kind::sparse) {
          const auto begin = out.rows.begin() + out.column_start[j],
                     end = out.rows.begin() + out.column_start[j + 1];
          at = static_cast<size_t>(std::lower_bound(begin, end, i) - out.rows.begin());
        }
        nodes[static_cast<size_t>(p.variable / n) * values + at] = p.node;
      }
    }
    out.program = program(nodes);
  }

  const OdeDef& def_;
  std::vector<uint32_t> order_, paired_;
  ExpressionGraph graph_;
  ExpressionNames names_;
  OdeModel model_;
  std::vector<Issue> issues_;
  int32_t first_state_ = 1;
  std::vector<Node> roots_, invariants_, guards_, plot_, tracer_roots_;
  std::vector<std::vector<Node>> event_values_;
};

}  // namespace

std::optional<Target> OdeModel::find(std::string_view name) const {
  std::string base(name.substr(0, name.find('[')));
  size_t index = 0;
  const bool indexed = base.size() < name.size();
  if (indexed) {
    const char* end = name.data() + name.size() - 1;
    const auto [rest, error] = std::from_chars(name.data() + base.size() + 1, end, index);
    if (name.back() != ']' || rest != end || error != std::errc{}) return std::nullopt;
  }
  for (const auto kind : {Target::Kind::state, Target::Kind::parameter}) {
    for (const Named& n : kind == Target::Kind::state ? states : parameters) {
      if (n.name != base || index >= n.places.size() || indexed != (n.form == NamedNumbers::Form::array))
        continue;
      return Target{kind, n.places[index]};
    }
  }
  return std::nullopt;
}

OdeModel compile_ode(const OdeDef& def) {
  try {
    Compiler first(def, {});
    OdeModel model = first.compile();
    if (first.paired().empty() || model.second_order) return model;
    // All states pair up, but stand in another order than positions, velocities: once more in that one.
    return Compiler(def, first.paired()).compile();
  } catch (const ExpressionFault& fault) {
    throw Error("scene_invalid", fault.message,
                {{"/equations", "bad_expression", fault.message, "", "", "", ""}});
  }
}

}  // namespace truestep
