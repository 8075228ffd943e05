// Arrays of a first-order integration: `Count` of them, each as long as the system. Those of few equations
// lie in the object itself, W elements each with zeros behind the last, so that loops unroll; for W = 0 they
// lie in the workspace. What a method computes does not depend on W: sums are added up in an order that
// follows from the number of equations alone.
#pragma once
#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "engine/base/errors.h"
#include "engine/integrators/advance.h"

namespace truestep {

/// The order in which `sum` adds: eight lanes, or halves upon halves, the first with the last.
enum class SumOrder : uint8_t { lanes, halves };

/// The most elements that are added in halves.
inline constexpr size_t kMostHalved = 12;
/// In which explicit pairs add the squares of n errors.
inline SumOrder order_of_sums(size_t n) {
  return n <= 4 || n == 6 || n == 8 || n == kMostHalved ? SumOrder::halves : SumOrder::lanes;
}

/// Elements of n in whole vector registers.
constexpr size_t width_of(size_t n) {
  return n <= 2 ? n : (n + 3) / 4 * 4;
}

namespace detail {
/// In halves; terms beyond `n` are 0.
template <size_t N>
double halved(std::array<double, N>& terms, size_t n) {
  for (size_t half = n; half > 1; half = (half + 1) / 2) {
    for (size_t i = 0; i < half / 2; ++i) terms[i] += terms[half - 1 - i];
  }
  return terms[0];
}
/// The same of the n <= 12 first, which come with whatever stands behind them.
double halved_few(std::array<double, kMostHalved>& terms, size_t n);
}  // namespace detail

/// N: the number of elements where the method knows it as well.
template <size_t W, size_t Count, size_t N = 0>
class Arrays {
 public:
  Arrays(const Advance&, std::string_view, size_t n, SumOrder = SumOrder::halves) : n_(n) {}
  double* operator[](size_t i) { return data_[i].data(); }
  const double* operator[](size_t i) const { return data_[i].data(); }
  void exchange(size_t i, size_t j) { std::swap(data_[i], data_[j]); }
  /// Array i takes the contents of array j.
  void take(size_t i, size_t j) { data_[i] = data_[j]; }

  /// body(i) for every element and the zeros; iterations do not depend on each other. One by one where they
  /// are few: what f has just written one by one would be waited for if it were read as a vector.
  template <class Body>
  void loop(Body body) const {
    if constexpr (W <= 4) {
#pragma GCC unroll 4
      for (size_t i = 0; i < W; ++i) body(i);
    } else {
#pragma GCC ivdep
      for (size_t i = 0; i < W; ++i) body(i);
    }
  }
  /// Sum of term(i) over the elements; term is asked of the zeros as well.
  template <class Term>
  double sum(Term term) const {
    alignas(32) std::array<double, W> terms;
    for (size_t i = 0; i < W; ++i) terms[i] = term(i);
    const size_t n = N ? N : n_;
    if (n != W) {
      for (size_t i = 0; i < W; ++i) terms[i] = i < n ? terms[i] : 0;
    }
    return detail::halved(terms, W);
  }

 private:
  size_t n_;
  alignas(32) std::array<std::array<double, W>, Count> data_{};
};

/// The zeros behind the last up to a whole vector register are looped over as well, so that loops have no
/// rest.
template <size_t Count>
class Arrays<0, Count, 0> {
 public:
  Arrays(const Advance& in, std::string_view key, size_t n, SumOrder order = SumOrder::lanes)
      : n_(n),
        width_((n + 3) / 4 * 4),
        order_(order),
        arena_(n > kBlock ? in.arena : nullptr),
        workspace_(in.workspace) {
    // Whole cache lines each, so that loops over different arrays are equally aligned.
    const size_t stride = (n + 7) / 8 * 8;
    double* data = in.workspace.doubles(key, stride * Count).data();
    for (size_t i = 0; i < Count; ++i) {
      data_[i] = data + i * stride;
      std::fill(data_[i] + n, data_[i] + width_, 0.0);
    }
  }
  double* operator[](size_t i) { return data_[i]; }
  const double* operator[](size_t i) const { return data_[i]; }
  void exchange(size_t i, size_t j) { std::swap(data_[i], data_[j]); }
  void take(size_t i, size_t j) { exchange(i, j); }

  template <class Body>
  void loop(Body body) const {
    if (arena_) {
      arena_->for_blocks(width_, kBlock, [body](size_t begin, size_t end) { run(begin, end, body); });
    } else {
      run(0, width_, body);
    }
  }
  /// In lanes with an arena for each block: the same on every machine and for any number of threads.
  template <class Term>
  double sum(Term term) const {
    if (order_ == SumOrder::halves) return sum_of_few(n_, term);
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
    const size_t quarters = (end - begin) / 4;
#pragma GCC ivdep
    for (size_t i = 0; i < 4 * quarters; ++i) body(begin + i);
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

  template <class Term>
  [[gnu::flatten]] static double sum_of_few(size_t n, Term term) {
    std::array<double, kMostHalved> terms;
    const size_t quarters = (n + 3) / 4;
    for (size_t i = 0; i < 4 * quarters; ++i) terms[i] = term(i);
    return detail::halved_few(terms, n);
  }

  size_t n_, width_;
  SumOrder order_;
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
  const bool named = ((n == Sizes && (run.template operator()<Sizes>(), true)) || ...);
  if (!named) run.template operator()<0>();
}
/// Calls run.operator()<W>() with the first of Widths that is right for n elements, otherwise with 0.
template <size_t... Widths, class Run>
void with_width(size_t n, Run&& run) {
  const bool right =
      (((n <= 4 ? n <= Widths : width_of(n) == Widths) && (run.template operator()<Widths>(), true)) || ...);
  if (!right) run.template operator()<0>();
}

}  // namespace truestep
