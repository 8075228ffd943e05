#include "tests/convergence/extended.h"

#include <algorithm>
#include <array>

namespace truestep::test {

namespace {

constexpr size_t kMost = 7, kMostStages = 17;  // components of y, stages
using Vector = std::array<Extended, kMost>;
using Stages = std::array<Vector, kMostStages>;

void derivative(const ExtendedProblem& p, const Extended* y, Extended* d) {
  const Extended *x = y, *v = y + p.nx;
  if (p.rate) {
    p.rate(x, v, d);
  } else {
    std::copy_n(v, p.nx, d);
  }
  p.acceleration(x, v, d + p.nx);
}

Extended size_of(Extended x) {
  return x < 0 ? -x : x;
}

}  // namespace

std::vector<ExtendedProblem> extended_problems() {
  static constexpr auto kSpring = [](const Extended* x, const Extended*, Extended* a) {
    for (int i = 0; i < 3; ++i) a[i] = -4 * x[i];
  };
  static constexpr auto kDamped = [](const Extended* x, const Extended* v, Extended* a) {
    for (int i = 0; i < 3; ++i) a[i] = -4 * x[i] - Extended(0.6) * v[i];
  };
  static constexpr auto kKepler = [](const Extended* x, const Extended*, Extended* a) {
    kepler_acceleration(x, a);
  };
  static constexpr auto kBody = [](const Extended*, const Extended* w, Extended* a) {
    free_body_acceleration(w, a);
  };
  return {{"oscillator", oscillator, 3, 3, false, kSpring},
          {"damped_oscillator", damped_oscillator, 3, 3, true, kDamped},
          {"kepler", kepler, 3, 3, false, kKepler},
          {"free_body", free_body, 4, 3, true, kBody, free_body_rate<Extended>, normalise<Extended>}};
}

ExtendedStep extended(const Tableau& t) {
  return [t](const ExtendedProblem& p, Extended h, Extended* y) {
    const size_t n = p.nx + p.nv;
    Stages k;
    Vector at;
    for (size_t i = 0; i < t.stages; ++i) {
      std::copy_n(y, n, at.begin());
      for (size_t j = 0; j < i; ++j) {
        if (t.a[i][j] == 0) continue;
        for (size_t c = 0; c < n; ++c) at[c] += h * t.a[i][j] * k[j][c];
      }
      derivative(p, at.data(), k[i].data());
    }
    for (size_t i = 0; i < t.stages; ++i) {
      for (size_t c = 0; c < n; ++c) y[c] += h * t.b[i] * k[i][c];
    }
  };
}

ExtendedStep extended(const NystromTableau& t) {
  return [t](const ExtendedProblem& p, Extended h, Extended* y) {
    const size_t n = p.nx;
    Extended *x = y, *v = y + n;
    Stages k;
    Vector at;
    for (size_t i = 0; i < t.stages; ++i) {
      for (size_t c = 0; c < n; ++c) {
        at[c] = x[c] + h * t.c[i] * v[c];
        for (size_t j = 0; j < i; ++j) at[c] += h * h * t.a[i][j] * k[j][c];
      }
      p.acceleration(at.data(), nullptr, k[i].data());
    }
    for (size_t c = 0; c < n; ++c) {
      x[c] += h * v[c];
      for (size_t i = 0; i < t.stages; ++i) {
        x[c] += h * h * t.b[i] * k[i][c], v[c] += h * t.bv[i] * k[i][c];
      }
    }
  };
}

ExtendedStep extended(const Splitting& s) {
  return [s](const ExtendedProblem& p, Extended h, Extended* y) {
    const size_t n = p.nx;
    Vector a;
    for (size_t i = 0; i <= s.kicks; ++i) {
      for (size_t c = 0; c < n; ++c) y[c] += s.drift[i] * h * y[n + c];
      if (i == s.kicks) break;
      p.acceleration(y, nullptr, a.data());
      for (size_t c = 0; c < n; ++c) y[n + c] += s.kick[i] * h * a[c];
    }
  };
}

ExtendedStep extended_collocation(const std::array<double, 8>& nodes) {
  // Integrals from 0 to s_j (j = 8: to 1) of the Lagrange polynomials, once and twice.
  std::array<std::array<Extended, 8>, 9> once{}, twice{};
  for (size_t i = 0; i < 8; ++i) {
    std::array<Extended, 8> power{1};
    for (size_t m = 0, degree = 0; m < 8; ++m) {
      if (m == i) continue;
      ++degree;
      const Extended gap = Extended(nodes[i]) - nodes[m];
      for (size_t d = degree + 1; d-- > 0;) {
        power[d] = ((d > 0 ? power[d - 1] : 0) - (d < degree ? power[d] * nodes[m] : 0)) / gap;
      }
    }
    for (size_t j = 0; j < 9; ++j) {
      const Extended s = j < 8 ? nodes[j] : 1;
      Extended to = s;
      for (size_t d = 0; d < 8; ++d, to *= s) {
        const Extended order = static_cast<double>(d + 1);
        once[j][i] += power[d] * to / order;
        twice[j][i] += power[d] * to * s / (order * (order + 1));
      }
    }
  }
  return [once, twice, nodes](const ExtendedProblem& p, Extended h, Extended* y) {
    const size_t n = p.nx;
    std::array<Vector, 8> a;
    Vector at;
    const auto place = [&](size_t j, Extended s, Extended* out) {
      for (size_t c = 0; c < n; ++c) {
        Extended x = 0, v = 0;
        for (size_t i = 0; i < 8; ++i) x += twice[j][i] * a[i][c], v += once[j][i] * a[i][c];
        out[c] = y[c] + h * s * y[n + c] + h * h * x;
        out[n + c] = y[n + c] + h * v;
      }
    };
    p.acceleration(y, y + n, a[0].data());
    for (size_t j = 1; j < 8; ++j) a[j] = a[0];
    for (int round = 0; round < 200; ++round) {
      Extended change = 0;
      for (size_t j = 1; j < 8; ++j) {
        const Vector before = a[j];
        place(j, nodes[j], at.data());
        p.acceleration(at.data(), at.data() + n, a[j].data());
        for (size_t c = 0; c < n; ++c) change = std::max(change, size_of(a[j][c] - before[c]));
      }
      if (change < 1e-28) break;
    }
    place(8, 1, at.data());
    std::copy_n(at.begin(), 2 * n, y);
  };
}

std::vector<Extended> extended_end(const ExtendedStep& step, const ExtendedProblem& problem, size_t steps) {
  const Problem p = problem.in_double();
  const State s = p.field->initial_state();
  std::vector<Extended> y;
  for (const char* column : {"position", "velocity"}) {
    for (const double c : s.f64(s.at(column))) y.push_back(c);
  }
  const Extended h = Extended(p.t_end) / static_cast<double>(steps);
  for (size_t n = 0; n < steps; ++n) {
    step(problem, h, y.data());
    if (problem.project) problem.project(y.data());
  }
  return y;
}

double extended_order(const ExtendedStep& step, const ExtendedProblem& problem, int dropped, const Fit& fit) {
  // Divided differences over 1, 1/2, 1/3 ... of the ends after n, 2n, 3n ... steps vanish for polynomials in
  // h of degree `dropped`.
  const int count = dropped + 2;
  std::vector<Extended> weight;
  for (int k = 1; k <= count; ++k) {
    Extended w = 1;
    for (int j = 1; j <= count; ++j) {
      // 1/(1/k - 1/j) over the same for k = 1.
      if (j != k) w *= Extended(k * j) / (j - k);
      if (j != 1) w /= Extended(j) / (j - 1);
    }
    weight.push_back(w);
  }
  return fitted_order(
      [&](size_t n) {
        std::vector<Extended> term;
        for (int k = 1; k <= count; ++k) {
          const auto y = extended_end(step, problem, n * static_cast<size_t>(k));
          term.resize(y.size());
          for (size_t i = 0; i < y.size(); ++i) term[i] += weight[static_cast<size_t>(k - 1)] * y[i];
        }
        Extended sum = 0;
        for (const Extended e : term) sum += e * e;
        return static_cast<double>(root(sum));
      },
      fit);
}

}  // namespace truestep::test
