// The linear system of an implicit step under gravity, (M - h^2 K) dv = h m g, with held rows left out.
#pragma once
#include <vector>

#include "engine/core/equations/force_field.h"

namespace truestep::bench {

struct ImplicitMatrix {
  BlockSparse a;
  std::vector<double> b;
};

enum class Slopes { exact, definite };

/// Of the forces as they are in `state`, whose columns are called position, velocity and inverse_mass.
inline ImplicitMatrix implicit_matrix(const ForceField& field, State& state, double h, Slopes slopes,
                                      Workspace& workspace, const ThreadArena& arena) {
  const auto x = state.f64(state.at("position")), v = state.f64(state.at("velocity")),
             w = state.f64(state.at("inverse_mass"));
  Evaluation e{workspace, arena};
  ImplicitMatrix out;
  BlockSparse dfdv;
  field.jacobian_pattern(state, out.a, dfdv);
  const Phase at{0, x, v, state};
  slopes == Slopes::definite ? field.definite_jacobian(at, out.a, dfdv, e)
                             : field.jacobian(at, out.a, dfdv, e);
  BlockSparse& a = out.a;
  for (size_t i = 0; i < w.size(); ++i) {
    for (auto s = a.row_begin(i); s < a.row_begin(i + 1); ++s) {
      const bool held = !(w[i] > 0) || !(w[a.column(s)] > 0);
      for (double& value : a.block(s)) value = held ? 0 : -h * h * value;
    }
    const auto diagonal = a.block(a.diagonal_slot(i));
    for (size_t c = 0; c < 3; ++c) diagonal[4 * c] += w[i] > 0 ? 1 / w[i] : 1;
    out.b.insert(out.b.end(), {0.0, w[i] > 0 ? -9.81 * h / w[i] : 0.0, 0.0});
  }
  return out;
}

}  // namespace truestep::bench
