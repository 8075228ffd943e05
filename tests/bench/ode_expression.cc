// Time of one evaluation of a right-hand side written as text beside the same equations in C++: the seven
// bodies of Pleiades, a chain of 1,000 masses, the van der Pol oscillator; and of a flow at 100,000 points.
#include <array>
#include <cmath>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/math/expression/names.h"
#include "engine/math/expression/program.h"
#include "engine/math/expression/rows.h"
#include "engine/math/trig.h"
#include "tests/bench/report.h"

namespace truestep::bench {
namespace {

using Node = ExpressionGraph::Node;

/// Variables, then equations, one text per family.
class Equations {
 public:
  void value(const char* name) { names_.add_value(name, graph_.variable(variables_++)); }
  void array(const char* name, size_t n) {
    std::vector<Node> nodes;
    for (size_t i = 0; i < n; ++i) nodes.push_back(graph_.variable(variables_++));
    names_.add_array(name, std::move(nodes));
  }
  void equation(const char* text) { roots_.push_back(names_.require(graph_, text)); }
  void family(const char* text, size_t n) {
    for (size_t i = 0; i < n; ++i) {
      roots_.push_back(names_.require(graph_, text, {{"i", static_cast<int64_t>(i)}}));
    }
  }
  ExpressionProgram program() const { return {graph_, roots_, static_cast<size_t>(variables_)}; }
  ExpressionRows rows() const { return {graph_, roots_}; }

 private:
  ExpressionGraph graph_;
  ExpressionNames names_;
  std::vector<Node> roots_;
  int32_t variables_ = 0;
};

// The peers are kept from being inlined into the loop around them, as a library's functions would be.
[[gnu::noinline]] void pleiades(const double* y, const double* m, double* d) {
  for (int i = 0; i < 7; ++i) d[i] = y[14 + i], d[7 + i] = y[21 + i];
  for (int i = 0; i < 7; ++i) {
    double ax = 0, ay = 0;
    for (int j = 0; j < 7; ++j) {
      if (j == i) continue;
      const double dx = y[j] - y[i], dy = y[7 + j] - y[7 + i], r2 = dx * dx + dy * dy;
      const double w = m[j] / (r2 * std::sqrt(r2));
      ax += w * dx, ay += w * dy;
    }
    d[14 + i] = ax, d[21 + i] = ay;
  }
}
[[gnu::noinline]] void pleiades_by_pairs(const double* y, const double* m, double* d) {
  for (int i = 0; i < 7; ++i) d[i] = y[14 + i], d[7 + i] = y[21 + i], d[14 + i] = d[21 + i] = 0;
  for (int i = 0; i < 7; ++i) {
    for (int j = i + 1; j < 7; ++j) {
      const double dx = y[j] - y[i], dy = y[7 + j] - y[7 + i], r2 = dx * dx + dy * dy;
      const double w = 1 / (r2 * std::sqrt(r2));
      d[14 + i] += m[j] * w * dx, d[21 + i] += m[j] * w * dy;
      d[14 + j] -= m[i] * w * dx, d[21 + j] -= m[i] * w * dy;
    }
  }
}
[[gnu::noinline]] void chain(const double* y, size_t n, double k, double* d) {
  for (size_t i = 0; i < n; ++i) {
    const double left = i > 0 ? y[i - 1] : 0, right = i + 1 < n ? y[i + 1] : 0;
    d[i] = y[n + i];
    d[n + i] = k * (left - 2 * y[i] + right);
  }
}
[[gnu::noinline]] void van_der_pol(const double* y, double mu, double* d) {
  d[0] = y[1];
  d[1] = mu * (1 - y[0] * y[0]) * y[1] - y[0];
}

/// Median seconds of one evaluation, ours (y first, then the parameters) and the peer's.
template <class Peer>
void compare(const char* what, const Equations& e, const std::vector<double>& values, size_t states,
             const char* peer_name, Peer peer) {
  const ExpressionProgram p = e.program();
  std::vector<double, CacheLineAllocator<double>> r(p.registers()), ours(p.outputs()), theirs(p.outputs());
  p.start(r.data());
  std::copy(values.begin(), values.end(), r.begin());
  std::vector<double> y(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(states));
  const int repeats = states > 100 ? 2000 : 100000;
  // As in an integration the states are copied in and every result feeds the next argument.
  const Times t = interleaved(
      15,
      [&] {
        for (int k = 0; k < repeats; ++k) {
          y[0] = values[0] + 1e-30 * ours[0];
          std::copy(y.begin(), y.end(), r.begin());
          p.run(r.data(), ours.data());
        }
      },
      [&] {
        for (int k = 0; k < repeats; ++k) {
          y[0] = values[0] + 1e-30 * theirs[0];
          peer(y.data(), theirs.data());
        }
      });
  double worst = 0;
  for (size_t i = 0; i < ours.size(); ++i) worst = std::fmax(worst, std::fabs(ours[i] - theirs[i]));
  Comparison c;
  c.bench = "ode_expression";
  c.metric = what;
  c.ours = t.ours / repeats, c.peer = t.peer / repeats;
  c.peer_name = peer_name;
  c.error_ours = worst, c.error_peer = 0;
  report(c);
}

void flow() {
  Equations e;
  for (const char* name : {"x", "y", "z"}) e.value(name);
  e.equation("sin(z) + 0.8 * cos(y)");
  e.equation("0.9 * sin(x) + cos(z)");
  e.equation("0.8 * sin(y) + 0.9 * cos(x)");
  const ExpressionRows rows = e.rows();
  constexpr size_t kPoints = 100'000;
  std::vector<double> x(3 * kPoints), ours(3 * kPoints), theirs(3 * kPoints);
  for (size_t i = 0; i < x.size(); ++i) x[i] = std::fmod(0.618034 * static_cast<double>(i), 6.28);
  const ExpressionRows::Column in[] = {{x.data(), 3}, {x.data() + 1, 3}, {x.data() + 2, 3}};
  const ExpressionRows::Output out[] = {{ours.data(), 3}, {ours.data() + 1, 3}, {ours.data() + 2, 3}};
  const Times t = interleaved(
      15, [&] { rows.run(in, out, 0, kPoints); },
      [&] {
        for (size_t i = 0; i < kPoints; ++i) {
          const auto a = trig::sincos(x[3 * i]), b = trig::sincos(x[3 * i + 1]),
                     c = trig::sincos(x[3 * i + 2]);
          theirs[3 * i] = c.sin + 0.8 * b.cos;
          theirs[3 * i + 1] = 0.9 * a.sin + c.cos;
          theirs[3 * i + 2] = 0.8 * b.sin + 0.9 * a.cos;
        }
      });
  Comparison c;
  c.bench = "ode_expression";
  c.metric = "seconds per point of an ABC flow";
  c.ours = t.ours / kPoints, c.peer = t.peer / kPoints;
  c.peer_name = "compiled C++, one point at a time";
  double worst = 0;
  for (size_t i = 0; i < ours.size(); ++i) worst = std::fmax(worst, std::fabs(ours[i] - theirs[i]));
  c.error_ours = worst, c.error_peer = 0;
  report(c);
}

void run() {
  const std::vector<double> stars = {3, 3,    -1,   -3, 2, -2, 2,     3, -3, 2, 0, 0, -4, 4, 0, 0, 0, 0,
                                     0, 1.75, -1.5, 0,  0, 0,  -1.25, 1, 0,  0, 1, 2, 3,  4, 5, 6, 7};
  for (const char* how : {"as written", "with a definition"}) {
    Equations e;
    for (const char* name : {"x", "y", "vx", "vy", "m"}) e.array(name, 7);
    e.family("vx[i]", 7);
    e.family("vy[i]", 7);
    const bool plain = how[0] == 'a';
    for (const char* c : {"x", "y"}) {
      const std::string d = std::string("(") + c + "[j] - " + c + "[i])";
      const std::string r2 = "((x[j] - x[i])^2 + (y[j] - y[i])^2)";
      e.family((plain ? "sum(j != i, m[j] * " + d + " / " + r2 + "^1.5)"
                      : "sum(j != i, m[j] * " + r2 + "^-1.5 * " + d + ")")
                   .c_str(),
               7);
    }
    const std::string what = std::string("seconds per right-hand side of Pleiades, ") + how;
    const double* m = stars.data() + 28;
    compare(what.c_str(), e, stars, 28, "compiled C++ (-O3), a loop over j for every i",
            [m](const double* y, double* d) { pleiades(y, m, d); });
    compare(what.c_str(), e, stars, 28, "compiled C++ (-O3), every pair once",
            [m](const double* y, double* d) { pleiades_by_pairs(y, m, d); });
  }
  {
    Equations e;
    constexpr size_t kMasses = 1000;
    e.array("x", kMasses);
    e.array("v", kMasses);
    e.value("k");
    e.family("v[i]", kMasses);
    e.family("k * ((i == 0 ? 0 : x[i - 1]) - 2 * x[i] + (i == len(x) - 1 ? 0 : x[i + 1]))", kMasses);
    std::vector<double> values(2 * kMasses + 1);
    for (size_t i = 0; i < values.size(); ++i) values[i] = std::sin(static_cast<double>(i));
    values.back() = 1e6;
    compare("seconds per right-hand side of a chain of 1000 masses", e, values, 2 * kMasses,
            "compiled C++ (-O3)", [](const double* y, double* d) { chain(y, kMasses, 1e6, d); });
  }
  {
    Equations e;
    for (const char* name : {"x", "y", "mu"}) e.value(name);
    e.equation("y");
    e.equation("mu * (1 - x^2) * y - x");
    compare("seconds per right-hand side of van der Pol", e, {2, -0.6, 5}, 2, "compiled C++ (-O3)",
            [](const double* y, double* d) { van_der_pol(y, 5, d); });
  }
  flow();
}

}  // namespace
}  // namespace truestep::bench

int main() {
  truestep::bench::run();
}
