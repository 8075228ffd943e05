#include "engine/integrators/linear/sparse_factors.h"

#include <algorithm>
#include <complex>
#include <vector>

#include "engine/integrators/linear/symmetric_factors.h"
#include "engine/math/solvers/sparse/sparse_lu.h"

namespace truestep {

namespace {

template <class T>
struct Solver {
  std::vector<T> values;
  std::unique_ptr<SparseLu<T>> lu;
};

std::complex<double> standard(Complex z) {
  return {z.re, z.im};
}
double standard(double z) {
  return z;
}

}  // namespace

struct SparseFactors::Parts {
  size_t n;
  std::vector<int> start, rows;
  std::vector<int32_t> given_start, given_rows;  // without the added diagonal
  std::unique_ptr<SymmetricFactors> symmetric;   // once asked for
  bool is_symmetric = false;                     // the last real factors
  std::vector<size_t> place;  // position of every given entry among the values including the diagonal
  std::vector<size_t> diagonal;
  Solver<double> real;
  Solver<std::complex<double>> complex;

  template <class T, class C>
  bool factor(Solver<T>& s, const double* a1, const double* a2, C c1, C c2) {
    if (!s.lu) {
      s.values.resize(rows.size());
      s.lu = make_sparse_lu<T>();
      s.lu->analyse(int(n), start.data(), rows.data());
    }
    T* v = s.values.data();
    std::fill_n(v, rows.size(), T(0));
    for (const size_t d : diagonal) v[d] = T(1);
    for (size_t k = 0; k < place.size(); ++k) {
      v[place[k]] -= a2 ? standard(a1[k] * c1 + a2[k] * c2) : standard(a1[k] * c1);
    }
    return s.lu->factor(v);
  }
};

SparseFactors::SparseFactors(size_t n, std::span<const int32_t> column_start, std::span<const int32_t> rows)
    : parts_(std::make_unique<Parts>()) {
  Parts& p = *parts_;
  p.n = n;
  p.given_start.assign(column_start.begin(), column_start.end());
  p.given_rows.assign(rows.begin(), rows.end());
  p.start.push_back(0);
  for (size_t j = 0; j < n; ++j) {
    bool has_diagonal = false;
    const auto diagonal = [&] {
      p.diagonal.push_back(p.rows.size());
      p.rows.push_back(int(j));
      has_diagonal = true;
    };
    for (int32_t k = column_start[j]; k < column_start[j + 1]; ++k) {
      const int32_t i = rows[size_t(k)];
      if (!has_diagonal && i > int32_t(j)) diagonal();
      p.place.push_back(p.rows.size());
      if (i == int32_t(j)) {
        diagonal();
      } else {
        p.rows.push_back(i);
      }
    }
    if (!has_diagonal) diagonal();
    p.start.push_back(int(p.rows.size()));
  }
}

SparseFactors::~SparseFactors() = default;

bool SparseFactors::factor(const double* a1, const double* a2, double c1, double c2,
                           std::span<const double> inverse_mass) {
  Parts& p = *parts_;
  p.is_symmetric = false;
  if (!inverse_mass.empty()) {
    if (!p.symmetric) p.symmetric = std::make_unique<SymmetricFactors>(p.n, p.given_start, p.given_rows);
    p.is_symmetric = p.symmetric->factor(a1, a2, c1, c2, inverse_mass);
    if (p.is_symmetric) return true;
  }
  return parts_->factor(parts_->real, a1, a2, c1, c2);
}
bool SparseFactors::factor(const double* a1, const double* a2, Complex c1, Complex c2) {
  return parts_->factor(parts_->complex, a1, a2, c1, c2);
}

void SparseFactors::solve(double* b) {
  if (parts_->is_symmetric) return parts_->symmetric->solve(b);
  parts_->real.lu->solve(b);
}
void SparseFactors::solve(Complex* b) {
  static_assert(sizeof(Complex) == sizeof(std::complex<double>));
  parts_->complex.lu->solve(reinterpret_cast<std::complex<double>*>(b));
}

}  // namespace truestep
