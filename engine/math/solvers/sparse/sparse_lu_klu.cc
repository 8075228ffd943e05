// Sparse LU by KLU (SuiteSparse, LGPL). klu_refactor, which reuses the pivots
// of an older matrix, is not used: its result depends on the run's past.
#include <klu.h>

#include <algorithm>
#include <type_traits>
#include <vector>

#include "engine/math/solvers/sparse/sparse_lu.h"

namespace truestep {

namespace {

template <class T>
class Klu final : public SparseLu<T> {
  static constexpr bool kReal = std::is_same_v<T, double>;

 public:
  Klu() { klu_defaults(&common_); }
  ~Klu() override { release(); }

  void analyse(int n, const int* column_start, const int* rows) override {
    release();
    n_ = n;
    start_.assign(column_start, column_start + n + 1);
    rows_.assign(rows, rows + column_start[n]);
    values_.resize(rows_.size());
    symbolic_ = klu_analyze(n, start_.data(), rows_.data(), &common_);
  }
  bool factor(const T* values) override {
    if (!symbolic_) return false;  // structurally singular
    std::copy_n(values, values_.size(), values_.begin());
    klu_free_numeric(&numeric_, &common_);
    auto* data = reinterpret_cast<double*>(values_.data());
    numeric_ = kReal ? klu_factor(start_.data(), rows_.data(), data, symbolic_, &common_)
                     : klu_z_factor(start_.data(), rows_.data(), data, symbolic_, &common_);
    return numeric_ && common_.status == KLU_OK;
  }
  void solve(T* b) override {
    auto* data = reinterpret_cast<double*>(b);
    if (kReal) {
      klu_solve(symbolic_, numeric_, n_, 1, data, &common_);
    } else {
      klu_z_solve(symbolic_, numeric_, n_, 1, data, &common_);
    }
  }

 private:
  void release() {
    if (numeric_) klu_free_numeric(&numeric_, &common_);
    if (symbolic_) klu_free_symbolic(&symbolic_, &common_);
  }

  klu_common common_{};
  klu_symbolic* symbolic_ = nullptr;
  klu_numeric* numeric_ = nullptr;
  int n_ = 0;
  std::vector<int> start_, rows_;
  std::vector<T> values_;
};

}  // namespace

template <class T>
std::unique_ptr<SparseLu<T>> make_klu_lu() {
  return std::make_unique<Klu<T>>();
}
template std::unique_ptr<SparseLu<double>> make_klu_lu();
template std::unique_ptr<SparseLu<std::complex<double>>> make_klu_lu();

}  // namespace truestep
