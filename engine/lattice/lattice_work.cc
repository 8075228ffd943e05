#include "engine/lattice/lattice_work.h"

#include <algorithm>

#include "engine/base/interrupt.h"

namespace truestep::lattice {

void LatticeWork::bind(const LatticeModel& model, const Constants& constants, const ThreadArena& arena) {
  arena_ = &arena;
  if (model_ == &model && constants_ == constants) return;
  if (model_ != &model) matrix_ = {};
  model_ = &model, constants_ = constants, t_ = 0;
  diffusion_ = Diffusion(model.lattice(), model.order(), model.coefficient(model.lattice(), constants, 0));
  forcing_.bind(model, diffusion_, constants);
  radius_.reset(), solver_.reset();
  matrix_stands_ = false;
  const Lattice& l = model.lattice();
  fixed_.resize(l.nodes());
  for (size_t i = 0; i < fixed_.size(); ++i) fixed_[i] = l.fixed(l.place(i));
}

void LatticeWork::move_to(double t) {
  if (!model_->coefficient_moves() || t == t_) return;
  t_ = t;
  diffusion_.coefficient() = model_->coefficient(model_->lattice(), constants_, t);
  forcing_.bind(*model_, diffusion_, constants_);
  radius_.reset();
  matrix_stands_ = false;
}

void LatticeWork::linearise(double t) {
  move_to(t);
  if (model_->coefficient_moves() && t != solver_time_) solver_.reset();
}

void LatticeWork::rate(double t, const double* u, double* out) {
  homogeneous(t, u, out);
  force(t, out);
}

bool LatticeWork::euler_in_place(double t, double h, double* u) {
  if (model_->forced()) return false;
  interruption_point();
  move_to(t);
  const size_t n = model_->lattice().nodes();
  if (arena_->threads() <= 1 && model_->lattice().dimensions > 1) {
    diffusion_.step_in_place(u, h, waiting_);
    return true;
  }
  // In place, threads would overwrite rows that others read. The sums are the same.
  waiting_.resize(n);
  diffusion_.apply(u, waiting_.data(), 1, h, *arena_);
  arena_->for_blocks(n, 4 * kBlockRows, [&](size_t begin, size_t end) {
    std::copy_n(&waiting_[begin], end - begin, u + begin);
  });
  return true;
}

bool LatticeWork::leapfrog_in_place(double t, double h, double* x, double* v) {
  if (model_->forced() || arena_->threads() > 1) return false;
  interruption_point();
  move_to(t);
  diffusion_.leapfrog_in_place(x, v, h, waiting_);
  return true;
}

void LatticeWork::homogeneous(double t, const double* u, double* out) {
  interruption_point();
  move_to(t);
  diffusion_.apply(u, out, 0, 1, *arena_);
}

void LatticeWork::force(double t, double* out) {
  forcing_.add(t, out, *arena_);
}

double LatticeWork::spectral_radius() {
  if (!radius_) radius_ = diffusion_.spectral_radius();
  return *radius_;
}

const Diffusion::Matrix& LatticeWork::matrix() {
  if (!matrix_stands_) {
    Diffusion::Matrix now = diffusion_.matrix();
    if (now.rows == matrix_.rows && now.column_start == matrix_.column_start) {
      matrix_.values = std::move(now.values);
    } else {
      matrix_ = std::move(now);
    }
    matrix_stands_ = true;
  }
  return matrix_;
}

ShiftedSolver* LatticeWork::solver() {
  if (!solver_) {
    solver_ = make_shifted_solver(*model_, constants_, t_, diffusion_);
    solver_time_ = t_;
  }
  return solver_.get();
}

}  // namespace truestep::lattice
