// Operations on one group of particles, one to a lane: stress and flow by its law, contributions to nodes,
// its fastest particle, deformation after a substep.
#pragma once
#include "engine/systems/mpm/blocks.h"
#include "engine/systems/mpm/solver.h"
#include "engine/systems/mpm/transfer.h"

namespace truestep::mpm {

/// What to compute from a deformation: the stress; the plastic flow; or both, flow first.
enum class Then : unsigned char { stress, flow, both };

template <int D, class T>
struct Group {
  using L = Layout<D>;
  using W = Wide<T>;
  static constexpr size_t kRowNumbers = (D + 1) * 4 * W::kLanes;  ///< of a group at its nodes

  static Square<D, T> load_square(const T* group, int component) {
    Square<D, T> out;
    for (int k = 0; k < D * D; ++k) out.m[k] = load(group + (component + k) * W::kLanes);
    return out;
  }
  static void store_square(T* group, int component, const Square<D, T>& a) {
    for (int k = 0; k < D * D; ++k) store(group + (component + k) * W::kLanes, a.m[k]);
  }

  static T largest_lane(W a) {
    T most = 0;
    for (int i = 0; i < W::kLanes; ++i) most = std::max(most, a[i]);
    return most;
  }
  /// Pressure only.
  static T respond_fluid(const Material& mat, T* group) {
    const Response<D, T> r = fluid_response<D, T>(mat, load(group + L::jacobian * W::kLanes));
    int c = L::tau;
    for (int i = 0; i < D; ++i) {
      for (int k = i; k < D; ++k) store(group + c++ * W::kLanes, i == k ? r.tau(0, 0) : W::zero());
    }
    return largest_lane(r.modulus);
  }

  /// Returns the largest modulus of a group; 0 if no stress was asked for.
  static T respond(const Piece& piece, T* group, Then then) {
    const Material& mat = piece.material;
    const bool plastic_law = mat.law == Law::snow || mat.law == Law::sand || mat.law == Law::foam;
    if (then == Then::flow && !plastic_law) return 0;
    if (mat.law == Law::fluid) return respond_fluid(mat, group);
    const W j = load(group + L::jacobian * W::kLanes);
    W plastic = load(group + L::plastic * W::kLanes);
    const Square<D, T> f = load_square(group, L::f);
    Response<D, T> r;
    if (then != Then::stress && plastic_law) {
      Svd<D, T> d = svd(f);
      return_map(mat, d, plastic);
      store_square(group, L::f, compose(d.u, d.s, d.v));
      store(group + L::plastic * W::kLanes, plastic);
      if (then == Then::flow) return 0;
      r = solid_response(mat, d, plastic);
    } else {
      r = response(piece, f, j, plastic);
    }
    int c = L::tau;
    for (int i = 0; i < D; ++i) {
      for (int k = i; k < D; ++k) store(group + c++ * W::kLanes, r.tau(i, k));
    }
    return largest_lane(r.modulus);
  }

  static double speed2(const T* group) {
    W sum = W::zero();
    for (int a = 0; a < D; ++a) {
      const W v = load(group + (L::v + a) * W::kLanes);
      sum = madd(v, v, sum);
    }
    return double{largest_lane(sum)};
  }

  /// The numbers that a group scatters to its nodes: mass and momentum, then columns of `keep` m C + `push`
  /// tau (transfer.h).
  static void contributions(const T* group, T mass, T keep, T push, T* rows) {
    const W zero = W::zero();
    const auto number = [&](int c) { return load(group + c * W::kLanes); };
    W four[4] = {W(mass), zero, zero, zero};
    for (int i = 0; i < D; ++i) four[i + 1] = W(mass) * number(L::v + i);
    to_rows(four, rows);
    W tau[D][D];
    int c = L::tau;
    for (int i = 0; i < D; ++i) {
      for (int q = i; q < D; ++q) tau[i][q] = tau[q][i] = W(push) * number(c++);
    }
    four[0] = zero;
    for (int q = 0; q < D; ++q) {
      for (int i = 0; i < D; ++i) four[i + 1] = madd(W(keep), number(L::c + D * i + q), tau[i][q]);
      to_rows(four, rows + (q + 1) * 4 * W::kLanes);
    }
  }

  /// Updates F and the volume ratio with the velocity gradient; a fluid has no F.
  static void deform(const Piece& piece, T* group, T h) {
    Square<D, T> c = load_square(group, L::c);
    const W hh(h);
    for (int k = 0; k < D * D; ++k) {
      c.m[k] = madd(hh, c.m[k], W(k % (D + 1) == 0 ? T{1} : T{0}));
    }
    if (piece.material.law != Law::fluid) store_square(group, L::f, c * load_square(group, L::f));
    const W j = load(group + L::jacobian * W::kLanes) * determinant(c);
    store(group + L::jacobian * W::kLanes, max(j, W(kLeastVolume)));
  }
};

}  // namespace truestep::mpm
