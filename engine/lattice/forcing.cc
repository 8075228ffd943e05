#include "engine/lattice/forcing.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/lattice/lattice_state.h"
#include "engine/math/expression/names.h"

namespace truestep::lattice {

namespace {

using Node = ExpressionGraph::Node;
using O = Operator;
enum Variable : int32_t { kT, kX, kY, kZ, kCoefficient, kDamping, kVariables };

/// Parses the texts and collects their errors.
class Reader {
 public:
  explicit Reader(size_t dimensions) {
    const char* const names[] = {"t", "x", "y", "z"};
    for (int32_t v = 0; v < static_cast<int32_t>(1 + dimensions); ++v) {
      names_.add_value(names[v], graph.variable(v));
    }
  }
  Node read(const std::string& pointer, const std::string& text) {
    try {
      return names_.require(graph, text);
    } catch (const ExpressionFault& f) {
      issues_.push_back({pointer, "bad_expression", describe(f, text), text, "", f.did_you_mean, ""});
      return graph.constant(0);
    }
  }
  Node derivative(Node f, int32_t variable) {
    std::vector<ExpressionGraph::Partial> out;
    graph.differentiate(f, variable, 1, out);
    return out.empty() ? graph.constant(0) : out[0].node;
  }
  void throw_faults() const {
    if (!issues_.empty()) throw Error("scene_invalid", issues_[0].message, issues_);
  }
  bool uses(Node f, int32_t variable) const {
    const auto all = graph.variables_of({&f, 1});
    return std::ranges::find(all, variable) != all.end();
  }
  ExpressionGraph graph;

 private:
  ExpressionNames names_;
  std::vector<Issue> issues_;
};

}  // namespace

LatticeModel::LatticeModel(const LatticeDef& def, SideKind usual, const Texts& texts)
    : lattice_(make_lattice(def, usual)),
      order_(def.order == LatticeDef::Order::fourth ? 4 : 2),
      time_order_(texts.time_order) {
  Reader r(lattice_.dimensions);
  const auto program = [&](std::vector<Node> roots) {
    Program p;
    p.rows = ExpressionRows(r.graph, roots);
    p.zero = std::ranges::all_of(roots, [&](Node n) { return r.graph.constant_value(n) == 0.0; });
    p.time = std::ranges::any_of(roots, [&](Node n) { return r.uses(n, kT); });
    return p;
  };
  std::vector<Node> initial;
  for (const auto& [pointer, text] : texts.initial) initial.push_back(r.read(pointer, text));
  Node c = r.read(texts.coefficient.first, texts.coefficient.second);
  const Node source = r.read(texts.source.first, texts.source.second);
  const std::optional<Node> exact =
      def.exact.empty() ? std::nullopt : std::optional(r.read("/exact", def.exact));
  std::array<std::array<Node, 2>, 3> given{};
  for (size_t a = 0; a < lattice_.dimensions; ++a) {
    for (size_t end = 0; end < 2; ++end) {
      const std::string pointer =
          def.sides.of(a, end) ? std::string("/sides/") + kSideNames[a][end] + "/value" : "/side/value";
      given[a][end] = r.read(pointer, side_value(def, a, end));
    }
  }
  r.throw_faults();
  if (texts.squared == Texts::Squared::yes) c = r.graph.binary(O::multiply, c, c);
  constant_coefficient_ = r.graph.constant_value(c);
  const auto refuse = [&](const std::string& why) {
    throw Error("scene_invalid", why, {texts.coefficient.first, "out_of_range", why, "", "", "", ""});
  };
  if (constant_coefficient_ && !(*constant_coefficient_ > 0 && std::isfinite(*constant_coefficient_))) {
    refuse("the coefficient must be a positive number");
  }
  if (order_ == 4 && !constant_coefficient_) {
    refuse("order 4 in space needs a constant coefficient: use order 2");
  }
  for (const Node n : initial) initial_.push_back(program({n}));
  coefficient_ = program({c}), source_ = program({source});
  if (exact) exact_ = program({*exact});
  forced_ = !source_.zero;

  for (size_t a = 0; a < 3; ++a) {
    coordinates_[a].resize(lattice_.count(a));
    for (size_t i = 0; i < coordinates_[a].size(); ++i) {
      coordinates_[a][i] = a < lattice_.dimensions ? lattice_.axes[a].at(i) : 0;
    }
  }
  for (size_t a = 0; a < lattice_.dimensions; ++a) {
    const Axis& axis = lattice_.axes[a];
    if (axis.periodic()) continue;
    for (size_t end = 0; end < 2; ++end) {
      Face f;
      f.axis = a, f.end = end, f.kind = axis.sides[end].kind, f.transfer = axis.sides[end].transfer;
      const Node g = given[a][end], g_t = r.derivative(g, kT), g_tt = r.derivative(g_t, kT);
      Node w = r.graph.constant(0);
      if (order_ == 4) {
        ExpressionGraph& graph = r.graph;
        w = g_t;
        if (time_order_ == 2) {
          w = graph.binary(O::add, g_tt, graph.binary(O::multiply, graph.variable(kDamping), g_t));
        }
        Node s = source;
        if (f.kind == SideKind::neumann) {
          s = r.derivative(source, static_cast<int32_t>(kX + a));
          if (end == 0) s = graph.unary(O::negate, s);
        }
        w = graph.binary(O::subtract, w, s);
        // Without this, 0 / c would count as a forcing.
        if (graph.constant_value(w) != 0.0) w = graph.binary(O::divide, w, graph.variable(kCoefficient));
        for (size_t b = 0; b < lattice_.dimensions; ++b) {
          if (b == a) continue;
          const auto v = static_cast<int32_t>(kX + b);
          w = graph.binary(O::subtract, w, r.derivative(r.derivative(g, v), v));
        }
      }
      f.values = program({g, g_t, g_tt, w});
      forced_ = forced_ || !f.values.zero;
      // An edge between two Dirichlet sides belongs to the first of them.
      for (size_t node = 0; node < lattice_.nodes(); ++node) {
        const auto p = lattice_.place(node);
        if (p[a] != (end == 0 ? 0 : axis.cells)) continue;
        bool taken = false;
        for (size_t b = 0; b < lattice_.dimensions; ++b) {
          taken =
              taken || (b != a && lattice_.axes[b].fixed(p[b]) && (b < a || f.kind != SideKind::dirichlet));
        }
        if (taken) continue;
        f.nodes.push_back(static_cast<uint32_t>(node));
        f.x.push_back(coordinates_[0][p[0]]), f.y.push_back(coordinates_[1][p[1]]);
        f.z.push_back(coordinates_[2][p[2]]);
      }
      faces_.push_back(std::move(f));
    }
  }
}

void LatticeModel::run(const Program& p, const Face& face, const Constants& c, double t,
                       std::vector<double>& out) const {
  const size_t n = face.nodes.size(), count = p.rows.outputs();
  out.resize(count * n);
  std::array<ExpressionRows::Column, kVariables> in{};
  in[kT] = {&t, 0}, in[kX] = {face.x.data(), 1}, in[kY] = {face.y.data(), 1}, in[kZ] = {face.z.data(), 1};
  in[kCoefficient] = {&c.coefficient, 0}, in[kDamping] = {&c.damping, 0};
  std::array<ExpressionRows::Output, 4> to;
  for (size_t k = 0; k < count; ++k) to[k] = {out.data() + k * n, 1};
  p.rows.run(in, {to.data(), count}, 0, n);
}

namespace {
constexpr size_t kNodes = 3;  // no shift

double coordinate(const Lattice& on, size_t shift, size_t axis, size_t i) {
  if (axis >= on.dimensions) return 0.0;
  return on.axes[axis].at(i) + (shift == axis ? 0.5 * on.axes[axis].spacing : 0.0);
}
std::vector<double> row_coordinates(const Lattice& on, size_t shift) {
  std::vector<double> x(on.count(0));
  for (size_t i = 0; i < x.size(); ++i) x[i] = coordinate(on, shift, 0, i);
  return x;
}

/// One value per node of `on`, shifted by half a spacing along `shift`, rows [begin, end); `x` holds the
/// row's coordinates.
void sample(const ExpressionRows& rows, const Lattice& on, size_t shift, const std::vector<double>& x,
            double t, double* out, size_t begin, size_t end) {
  const size_t nx = on.count(0), ny = on.count(1);
  const auto at = [&](size_t axis, size_t i) { return coordinate(on, shift, axis, i); };
  const double one = 1, none = 0;
  for (size_t r = begin; r < end; ++r) {
    const double y = at(1, r % ny), z = at(2, r / ny);
    const ExpressionRows::Column in[] = {{&t, 0}, {x.data(), 1}, {&y, 0}, {&z, 0}, {&one, 0}, {&none, 0}};
    const ExpressionRows::Output to[] = {{out + r * nx, 1}};
    rows.run(in, to, 0, nx);
  }
}
}  // namespace

std::vector<double> LatticeModel::initial(size_t which) const {
  std::vector<double> u(lattice_.nodes()), values;
  sample(initial_[which].rows, lattice_, kNodes, coordinates_[0], 0, u.data(), 0,
         lattice_.count(1) * lattice_.count(2));
  for (const Face& f : faces_) {
    if (f.kind != SideKind::dirichlet) continue;
    run(f.values, f, {}, 0, values);
    for (size_t k = 0; k < f.nodes.size(); ++k) u[f.nodes[k]] = values[which * f.nodes.size() + k];
  }
  return u;
}

std::optional<double> LatticeModel::distance_from_exact(std::span<const double> u, double t) const {
  if (!exact_) return std::nullopt;
  std::vector<double> squares(lattice_.nodes());
  sample(exact_->rows, lattice_, kNodes, coordinates_[0], t, squares.data(), 0,
         lattice_.count(1) * lattice_.count(2));
  double volume = 1;
  for (size_t a = 0; a < lattice_.dimensions; ++a) {
    volume *= lattice_.axes[a].spacing * static_cast<double>(lattice_.axes[a].cells);
  }
  for (size_t i = 0; i < squares.size(); ++i) squares[i] = (u[i] - squares[i]) * (u[i] - squares[i]);
  return std::sqrt(integral(lattice_, squares) / volume);
}

Coefficient LatticeModel::coefficient(const Lattice& on, const Constants& constants, double t) const {
  Coefficient c;
  c.constant = constants.coefficient;
  if (constant_coefficient_) return c;
  const size_t rows = on.count(1) * on.count(2);
  const auto take = [&](std::vector<double>& to, size_t shift) {
    to.resize(on.nodes());
    sample(coefficient_.rows, on, shift, row_coordinates(on, shift), t, to.data(), 0, rows);
  };
  take(c.nodes, kNodes);
  for (size_t a = 0; a < on.dimensions; ++a) {
    take(c.faces[a], a);
    // Faces beyond the last node do not exist.
    for (size_t node = 0; node < on.nodes(); ++node) {
      const double v = c.faces[a][node];
      if (!on.axes[a].periodic() && on.place(node)[a] == on.axes[a].cells) {
        c.faces[a][node] = 0;
      } else if (!(v >= 0) || !std::isfinite(v)) {
        throw Error(
            "scene_invalid", "the coefficient is negative or not a number somewhere in the box",
            {"", "out_of_range", "the coefficient must be at least 0 everywhere", "", ">= 0", "", ""});
      }
    }
  }
  return c;
}

void Forcing::bind(const LatticeModel& model, const Diffusion& diffusion, const Constants& constants) {
  model_ = &model, diffusion_ = &diffusion, constants_ = constants;
  steady_.clear(), steady_given_.clear(), source_.clear();
  const Lattice& l = model.lattice_;
  if (!model.source_.zero && !model.source_.time) {
    source_.resize(l.nodes());
    sample(model.source_.rows, l, kNodes, model.coordinates_[0], 0, source_.data(), 0,
           l.count(1) * l.count(2));
  }
  for (const LatticeModel::Face& f : model.faces_) {
    if (!f.values.time) side(f, 0, steady_, steady_given_);
  }
}

void Forcing::side(const LatticeModel::Face& face, double t, std::vector<std::pair<uint32_t, double>>& sums,
                   std::vector<std::pair<uint32_t, double>>& given) {
  const size_t n = face.nodes.size();
  const Axis& axis = model_->lattice_.axes[face.axis];
  const bool fixed = face.kind == SideKind::dirichlet;
  if (face.values.zero) {
    for (size_t k = 0; fixed && k < n; ++k) given.emplace_back(face.nodes[k], 0.0);
    return;
  }
  model_->run(face.values, face, constants_, t, values_);
  const double *g = values_.data(), *derivative = g + static_cast<size_t>(model_->time_order_) * n,
               *w = g + 3 * n, h = axis.spacing;
  // One and two nodes into the box.
  const auto inwards = static_cast<ptrdiff_t>(model_->lattice_.stride(face.axis)) * (face.end == 0 ? 1 : -1);
  for (size_t k = 0; k < n; ++k) {
    const uint32_t node = face.nodes[k];
    const double c = diffusion_->coefficient().at(node);
    const auto next = static_cast<uint32_t>(static_cast<ptrdiff_t>(node) + inwards);
    if (fixed) {
      given.emplace_back(node, derivative[k]);
      // The mirrored node is off by h^2 u_nn and enters with the weight -1/12.
      if (model_->order_ == 4) sums.emplace_back(next, -c * w[k] / 12);
    } else if (model_->order_ == 4) {
      const double first = h * g[k], third = h * h * h * w[k];
      sums.emplace_back(node, c * (28 * first + (8.0 / 3) * third) / (12 * h * h));
      sums.emplace_back(next, -c * (2 * first + third / 3) / (12 * h * h));
    } else {
      sums.emplace_back(node, 2 / h * c * (face.kind == SideKind::robin ? face.transfer : 1.0) * g[k]);
    }
  }
}

void Forcing::add(double t, double* out, const ThreadArena& arena) {
  const Lattice& l = model_->lattice_;
  if (!source_.empty()) {
    const double* s = source_.data();
    arena.for_blocks(l.nodes(), 4 * kBlockRows, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) out[i] += s[i];
    });
  } else if (!model_->source_.zero) {
    moving_source_.resize(l.nodes());
    const size_t block = std::max<size_t>(1, kBlockRows / l.count(0)), nx = l.count(0);
    double* s = moving_source_.data();
    arena.for_blocks(l.count(1) * l.count(2), block, [&](size_t begin, size_t end) {
      sample(model_->source_.rows, l, kNodes, model_->coordinates_[0], t, s, begin, end);
      for (size_t i = begin * nx; i < end * nx; ++i) out[i] += s[i];
    });
  }
  moving_.clear(), moving_given_.clear();
  for (const LatticeModel::Face& f : model_->faces_) {
    if (f.values.time) side(f, t, moving_, moving_given_);
  }
  for (const auto* list : {&steady_, &moving_}) {
    for (const auto& [node, b] : *list) out[node] += b;
  }
  for (const auto* list : {&steady_given_, &moving_given_}) {
    for (const auto& [node, b] : *list) out[node] = b;
  }
}

}  // namespace truestep::lattice
