// Arrays of a first-order integration: `Count` of them, each as long as the system. Small systems (N
// equations known at compile time) keep them in the object itself, padded with zeros to whole vectors, so
// that loops unroll; for N = 0 they lie in the workspace.
#pragma once
#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "engine/base/errors.h"
#include "engine/integrators/advance.h"

namespace truestep {

template <size_t N, size_t Count>
class Arrays {
 public:
  /// Elements that loops run over.
  static constexpr size_t kWidth = N <= 2 ? N : (N + 3) / 4 * 4;
  Arrays(const Advance&, std::string_view, size_t) {}
  double* operator[](size_t i) { return data_[i].data(); }
  const double* operator[](size_t i) const { return data_[i].data(); }
  void exchange(size_t i, size_t j) { std::swap(data_[i], data_[j]); }
  /// Array i takes the contents of array j.
  void take(size_t i, size_t j) { data_[i] = data_[j]; }

  /// body(i) for every element; iterations do not depend on each other.
  template <class Body>
  void loop(Body body) const {
#pragma GCC ivdep
    for (size_t i = 0; i < kWidth; ++i) body(i);
  }
  /// Sum of term(i) over the elements.
  template <class Term>
  double sum(Term term) const {
    alignas(32) std::array<double, kWidth> terms;
    for (size_t i = 0; i < kWidth; ++i) terms[i] = i < N ? term(i) : 0;
    for (size_t half = kWidth; half > 1; half = (half + 1) / 2) {
      for (size_t i = 0; i < half / 2; ++i) terms[i] += terms[half - 1 - i];
    }
    return terms[0];
  }

 private:
  alignas(32) std::array<std::array<double, kWidth>, Count> data_{};
};

template <size_t Count>
class Arrays<0, Count> {
 public:
  Arrays(const Advance& in, std::string_view key, size_t n)
      : n_(n), arena_(n > kBlock ? in.arena : nullptr), workspace_(in.workspace) {
    // Whole cache lines each, so that loops over different arrays are equally aligned.
    const size_t stride = (n + 7) / 8 * 8;
    double* data = in.workspace.doubles(key, stride * Count).data();
    for (size_t i = 0; i < Count; ++i) data_[i] = data + i * stride;
  }
  double* operator[](size_t i) { return data_[i]; }
  const double* operator[](size_t i) const { return data_[i]; }
  void exchange(size_t i, size_t j) { std::swap(data_[i], data_[j]); }
  void take(size_t i, size_t j) { exchange(i, j); }

  template <class Body>
  void loop(Body body) const {
    if (arena_) {
      arena_->for_blocks(n_, kBlock, [body](size_t begin, size_t end) { run(begin, end, body); });
    } else {
      run(0, n_, body);
    }
  }
  /// Eight interleaved partial sums, with an arena for each block: the same on every machine and for any
  /// number of threads.
  template <class Term>
  double sum(Term term) const {
    if (!arena_) return sum_of(0, n_, term);
    const auto partial = workspace_.doubles("integrator.partial", (n_ + kBlock - 1) / kBlock);
    arena_->for_blocks(n_, kBlock, [partial, term](size_t begin, size_t end) {
      partial[begin / kBlock] = sum_of(begin, end, term);
    });
    double all = 0;
    for (const double p : partial) all += p;
    return all;
  }

 private:
  /// 16 KiB per array, so that a few of them stay in the first cache.
  static constexpr size_t kBlock = 2048;

  // `flatten`: the twelve stages of a method of order 8 exceed what the compiler inlines by itself, and a
  // loop that calls is not vectorised. By value: what a copy refers to is read once, not in each iteration.
  template <class Body>
  [[gnu::flatten]] static void run(size_t begin, size_t end, Body body) {
#pragma GCC ivdep
    for (size_t i = begin; i < end; ++i) body(i);
  }
  template <class Term>
  [[gnu::flatten]] static double sum_of(size_t begin, size_t end, Term term) {
    alignas(32) std::array<double, 8> lanes{};
    size_t i = begin;
    for (; i + 8 <= end; i += 8) {
      for (size_t l = 0; l < 8; ++l) lanes[l] += term(i + l);
    }
    for (size_t l = 0; i < end; ++i, ++l) lanes[l] += term(i);
    return ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) + ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]));
  }

  size_t n_;
  const ThreadArena* arena_;
  Workspace& workspace_;
  std::array<double*, Count> data_{};
};

/// Number of positions of second-order equations; Error "unsuitable_method" for others.
inline size_t positions_of(const Advance& in) {
  if (!in.f.second_order()) throw Error("unsuitable_method", "the method needs equations of second order");
  return in.f.size() / 2;
}

/// Calls run.operator()<N>() with N = n if that is one of Sizes, otherwise with 0.
template <size_t... Sizes, class Run>
void with_size(size_t n, Run&& run) {
  const bool compiled = ((n == Sizes && (run.template operator()<Sizes>(), true)) || ...);
  if (!compiled) run.template operator()<0>();
}

}  // namespace truestep
