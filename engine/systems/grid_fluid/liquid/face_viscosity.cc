#include "engine/systems/grid_fluid/liquid/face_viscosity.h"

#include <algorithm>
#include <cmath>

namespace truestep::grid_fluid {

namespace {
// Minimum weight of faces that hardly touch the liquid, so that the matrix stays well conditioned.
constexpr double kLeastShare = 0.05;

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}
}  // namespace

void FaceViscosity::bind(const FlowModel& m, const MovingSolids& solids) {
  model_ = &m, solids_ = &solids;
  const size_t n = m.grid.size(), sides = 2 * m.grid.dimensions;
  row_.assign(n, kNone), face_.reserve(n), share_.reserve(n), diagonal_.reserve(n), push_.reserve(n);
  other_.reserve(sides * n), weight_.reserve(sides * n);
  for (std::vector<double>* v : {&x_, &r_, &p_, &q_, &z_}) v->reserve(n);
}

void FaceViscosity::find_faces(size_t c, const uint8_t* liquid, const double* depth) {
  const mac::MacGrid& g = model_->grid;
  const double* open = (*solids_)->any() ? (*solids_)->open[c].data() : nullptr;
  std::fill(row_.begin(), row_.end(), kNone);
  face_.clear(), share_.clear();
  for (size_t k = 0; k < g.count(c, 2); ++k) {
    for (size_t j = 0; j < g.count(c, 1); ++j) {
      for (size_t i = 0; i < g.count(c, 0); ++i) {
        const size_t at = g.at(i, j, k), low = at - g.stride(c), place = c == 0 ? i : c == 1 ? j : k;
        const bool side = !g.periodic[c] && (place == 0 || place == g.cells[c]);
        if (side || !(liquid[at] || liquid[low]) || (open && open[at] == 0)) continue;
        row_[at] = static_cast<int32_t>(face_.size());
        face_.push_back(static_cast<uint32_t>(at));
        share_.push_back(std::clamp(0.5 + 0.5 * (depth[at] + depth[low]), kLeastShare, 1.0));
      }
    }
  }
}

void FaceViscosity::join_faces(size_t c, double amount, const double* u) {
  const mac::MacGrid& g = model_->grid;
  const double* open = (*solids_)->any() ? (*solids_)->open[c].data() : nullptr;
  const size_t n = face_.size(), sides = 2 * g.dimensions;
  diagonal_.resize(n), push_.assign(n, 0), other_.assign(sides * n, kNone), weight_.assign(sides * n, 0);
  for (size_t row = 0; row < n; ++row) {
    size_t rest = face_[row];
    double diagonal = share_[row];
    for (size_t a = g.dimensions; a-- > 0;) {
      const size_t s = g.stride(a), padded = rest / s, place = padded - mac::kGhosts;
      rest -= padded * s;
      const double per = amount / (g.spacing[a] * g.spacing[a]);
      for (size_t end = 0; end < 2; ++end) {
        size_t at = end == 0 ? face_[row] - s : face_[row] + s;
        const size_t last = g.count(c, a) - 1;
        if (place == (end == 0 ? 0 : last)) {
          if (g.periodic[a]) {
            at = end == 0 ? face_[row] + last * s : face_[row] - last * s;
          } else {
            // Beyond a side, half a cell away. (Along the component's own axis, faces on sides are not rows.)
            if (model_->kinds[a][end] == SideKind::wall) diagonal += 2 * per * share_[row];
            continue;
          }
        }
        const int32_t neighbour = row_[at];
        const bool on_side = a == c && !g.periodic[a] && (end == 0 ? place == 1 : place + 1 == last);
        if (neighbour != kNone) {
          const double w = per * std::max(share_[row], share_[static_cast<size_t>(neighbour)]);
          diagonal += w;
          other_[sides * row + 2 * a + end] = neighbour, weight_[sides * row + 2 * a + end] = w;
        } else if (on_side && model_->kinds[a][end] == SideKind::outflow) {
          continue;  // no slope along the normal
        } else if (on_side || (open && open[at] == 0)) {
          diagonal += per * share_[row];
          if (!on_side || model_->kinds[a][end] == SideKind::inflow) push_[row] += per * share_[row] * u[at];
        }
      }
    }
    diagonal_[row] = diagonal;
  }
}

void FaceViscosity::multiply(const std::vector<double>& x, std::vector<double>& out,
                             const ThreadArena& arena) const {
  const size_t sides = 2 * model_->grid.dimensions;
  arena.for_blocks(x.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      double sum = diagonal_[row] * x[row];
      for (size_t m = sides * row; m < sides * (row + 1); ++m) {
        if (other_[m] != kNone) sum -= weight_[m] * x[static_cast<size_t>(other_[m])];
      }
      out[row] = sum;
    }
  });
}

lattice::CutPoisson::Outcome FaceViscosity::solve(size_t c, const uint8_t* liquid, const double* depth,
                                                  double amount, double tolerance, double* u,
                                                  const ThreadArena& arena) {
  find_faces(c, liquid, depth);
  join_faces(c, amount, u);
  const size_t n = face_.size();
  for (std::vector<double>* v : {&x_, &r_, &p_, &q_, &z_}) v->resize(n);
  lattice::CutPoisson::Outcome out;
  double before = 0;
  for (size_t row = 0; row < n; ++row) {
    x_[row] = u[face_[row]];
    const double b = share_[row] * x_[row] + push_[row];
    before += b * b;
  }
  multiply(x_, q_, arena);
  for (size_t row = 0; row < n; ++row) r_[row] = share_[row] * x_[row] + push_[row] - q_[row];
  double product = 0;
  if (!(before > 0)) return out;
  for (; out.iterations < kMostIterations; ++out.iterations) {
    out.residual = std::sqrt(dot(r_, r_) / before);
    if (!(out.residual > tolerance)) break;
    for (size_t row = 0; row < n; ++row) z_[row] = r_[row] / diagonal_[row];
    const double next = dot(r_, z_), keep = out.iterations > 0 ? next / product : 0;
    product = next;
    for (size_t row = 0; row < n; ++row) p_[row] = z_[row] + (keep == 0 ? 0 : keep * p_[row]);
    multiply(p_, q_, arena);
    const double along = product / dot(p_, q_);
    for (size_t row = 0; row < n; ++row) x_[row] += along * p_[row], r_[row] -= along * q_[row];
  }
  for (size_t row = 0; row < n; ++row) u[face_[row]] = x_[row];
  return out;
}

}  // namespace truestep::grid_fluid
