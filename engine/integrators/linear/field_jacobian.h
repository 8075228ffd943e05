// A force field's Jacobian, blocks of f = M a, as da/dx and da/dv in compressed columns of one pattern: as
// implicit methods on y' = f(t, y) need it for second-order equations. Lives in the workspace; the pattern is
// recomputed only when the field says that it has changed.
#pragma once
#include <vector>

#include "engine/core/equations/right_hand_side.h"
#include "engine/integrators/motion.h"
#include "engine/math/block_sparse.h"

namespace truestep {

class FieldJacobian {
 public:
  /// Must come first. The field must have a Jacobian.
  void bind(const Motion& m);
  /// Its spans stay valid until the pattern changes.
  MatrixShape shape() const {
    return {.kind = MatrixShape::Kind::sparse, .column_start = column_start_, .rows = rows_};
  }
  void evaluate(const Motion& m, double t, const double* x, const double* v, double* dadx, double* dadv);

 private:
  // Source of entry k of the columns: an element of a matrix's values, or kNowhere when it is 0.
  static constexpr uint32_t kNowhere = UINT32_MAX;
  void compress(const BlockSparse& matrix, std::vector<uint32_t>& source) const;

  const ForceField* field_ = nullptr;
  uint64_t version_ = 0;
  size_t points_ = 0;
  BlockSparse dfdx_, dfdv_;
  std::vector<int32_t> column_start_, rows_;
  std::vector<uint32_t> from_dfdx_, from_dfdv_;
};

}  // namespace truestep
