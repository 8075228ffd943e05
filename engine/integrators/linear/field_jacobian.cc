#include "engine/integrators/linear/field_jacobian.h"

#include <algorithm>

namespace truestep {

void FieldJacobian::bind(const Motion& m) {
  const uint64_t version = m.field.pattern_version(m.state);
  const size_t points = m.state.rows(m.state.at("velocity"));
  if (field_ == &m.field && version == version_ && points == points_) return;
  dfdv_ = BlockSparse();
  m.field.jacobian_pattern(m.state, dfdx_, dfdv_);
  // The union of both patterns: block columns of every block column, ascending (the patterns are symmetric).
  const auto b = static_cast<size_t>(dfdx_.block_size());
  column_start_.assign(1, 0);
  rows_.clear();
  std::vector<uint32_t> blocks;
  for (size_t j = 0; j < dfdx_.block_rows(); ++j) {
    blocks.clear();
    for (const BlockSparse* matrix : {&dfdx_, &dfdv_}) {
      if (matrix->empty()) continue;
      for (auto s = matrix->row_begin(j); s < matrix->row_begin(j + 1); ++s)
        blocks.push_back(matrix->column(s));
    }
    std::sort(blocks.begin(), blocks.end());
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
    for (size_t c = 0; c < b; ++c) {
      for (const uint32_t i : blocks) {
        for (size_t r = 0; r < b; ++r) rows_.push_back(static_cast<int32_t>(i * b + r));
      }
      column_start_.push_back(static_cast<int32_t>(rows_.size()));
    }
  }
  compress(dfdx_, from_dfdx_);
  compress(dfdv_, from_dfdv_);
  field_ = &m.field, version_ = version, points_ = points;
}

void FieldJacobian::compress(const BlockSparse& matrix, std::vector<uint32_t>& source) const {
  source.assign(rows_.size(), kNowhere);
  if (matrix.empty()) return;
  const auto b = static_cast<size_t>(matrix.block_size());
  for (size_t i = 0; i < matrix.block_rows(); ++i) {
    for (auto s = matrix.row_begin(i); s < matrix.row_begin(i + 1); ++s) {
      for (size_t c = 0; c < b; ++c) {
        const size_t column = matrix.column(s) * b + c;
        const auto begin = rows_.begin() + column_start_[column],
                   end = rows_.begin() + column_start_[column + 1];
        const auto first = std::lower_bound(begin, end, static_cast<int32_t>(i * b)) - rows_.begin();
        for (size_t r = 0; r < b; ++r) {
          source[static_cast<size_t>(first) + r] = static_cast<uint32_t>(s * b * b + c * b + r);
        }
      }
    }
  }
}

void FieldJacobian::evaluate(const Motion& m, double t, const double* x, const double* v, double* dadx,
                             double* dadv) {
  dfdx_.set_zero();
  if (!dfdv_.empty()) dfdv_.set_zero();
  Evaluation e{m.input.workspace, m.input.arena};
  m.field.jacobian({t, {x, m.x.size()}, {v, m.v.size()}, m.state}, dfdx_, dfdv_, e);
  const auto inverse_mass = m.field.inverse_mass(m.state);
  const auto b = static_cast<size_t>(dfdx_.block_size());
  const auto fill = [&](const BlockSparse& matrix, const std::vector<uint32_t>& source, double* to) {
    const auto values = matrix.values();
    for (size_t k = 0; k < source.size(); ++k) {
      to[k] = source[k] == kNowhere ? 0 : values[source[k]] * inverse_mass[static_cast<size_t>(rows_[k]) / b];
    }
  };
  fill(dfdx_, from_dfdx_, dadx);
  if (dfdv_.empty()) {
    std::fill_n(dadv, rows_.size(), 0.0);
  } else {
    fill(dfdv_, from_dfdv_, dadv);
  }
}

}  // namespace truestep
