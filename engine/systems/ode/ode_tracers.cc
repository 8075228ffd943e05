#include "engine/systems/ode/ode_tracers.h"

#include "engine/base/random.h"

namespace truestep::ode {

namespace {

constexpr size_t kBlockPoints = 512;

struct TracerStage {
  size_t when;  ///< 0, 1, 2: start, middle, end of the step
  double from;  ///< fraction of the previous stage's velocity that leads here
  double weight;
};
/// Methods in which every stage depends only on the one before.
std::span<const TracerStage> stages_of(TracersDef::Method method) {
  static constexpr TracerStage kEuler[] = {{0, 0, 1}}, kMidpoint[] = {{0, 0, 0}, {1, 0.5, 1}},
                               kHeun[] = {{0, 0, 0.5}, {2, 1, 0.5}},
                               kRk4[] = {
                                   {0, 0, 1.0 / 6}, {1, 0.5, 1.0 / 3}, {1, 0.5, 1.0 / 3}, {2, 1, 1.0 / 6}};
  switch (method) {
    case TracersDef::Method::euler:
      return kEuler;
    case TracersDef::Method::midpoint:
      return kMidpoint;
    case TracersDef::Method::heun:
      return kHeun;
    case TracersDef::Method::rk4:
      break;
  }
  return kRk4;
}

}  // namespace

std::vector<double> tracer_positions(const TracersDef& d, uint64_t seed) {
  const Vec3 size = d.box_max - d.box_min;
  std::vector<double> x;
  if (!d.points.empty()) {
    for (const Vec3& p : d.points) x.insert(x.end(), {p.x, p.y, p.z});
    return x;
  }
  if (!d.grid.empty()) {
    const auto at = [](int64_t i, int64_t n) {
      return n == 1 ? 0.5 : static_cast<double>(i) / static_cast<double>(n - 1);
    };
    for (int64_t k = 0; k < d.grid[2]; ++k) {
      for (int64_t j = 0; j < d.grid[1]; ++j) {
        for (int64_t i = 0; i < d.grid[0]; ++i) {
          x.insert(x.end(), {d.box_min.x + size.x * at(i, d.grid[0]), d.box_min.y + size.y * at(j, d.grid[1]),
                             d.box_min.z + size.z * at(k, d.grid[2])});
        }
      }
    }
    return x;
  }
  x.reserve(3 * static_cast<size_t>(d.count));
  for (int i = 0; i < d.count; ++i) {
    constexpr uint64_t kStream = 0x7ace;
    const auto u = uniform4(seed, kStream, static_cast<uint64_t>(i));
    x.insert(x.end(),
             {d.box_min.x + size.x * u[0], d.box_min.y + size.y * u[1], d.box_min.z + size.z * u[2]});
  }
  return x;
}

void move_tracers(const OdeModel& model, TracersDef::Method method, const OdeSurroundings& at,
                  std::span<double> positions, const ThreadArena& arena) {
  const auto stages = stages_of(method);
  const size_t parameters = at.parameters.size(), states = model.size();
  arena.for_blocks(positions.size() / 3, kBlockPoints, [&](size_t begin, size_t end) {
    double point[3 * kBlockPoints], velocity[3 * kBlockPoints], sum[3 * kBlockPoints];
    std::array<ExpressionRows::Column, 256> in;
    const ExpressionRows::Output out[] = {{velocity, 3}, {velocity + 1, 3}, {velocity + 2, 3}};
    const size_t n = 3 * (end - begin);
    double* const x = positions.data() + 3 * begin;
    std::copy_n(x, n, point);
    for (size_t p = 0; p < parameters; ++p) in[1 + p] = {at.parameters.data() + p, 0};
    for (size_t axis = 0; axis < 3; ++axis) in[1 + parameters + states + axis] = {point + axis, 3};
    for (size_t s = 0; s < stages.size(); ++s) {
      const TracerStage& stage = stages[s];
      const double time = at.t + 0.5 * static_cast<double>(stage.when) * at.h;
      in[0] = {&time, 0};
      for (size_t k = 0; k < states; ++k) in[1 + parameters + k] = {at.states[stage.when] + k, 0};
      if (s > 0) {
        for (size_t k = 0; k < n; ++k) point[k] = x[k] + at.h * stage.from * velocity[k];
      }
      model.tracer_velocity.run(in, out, 0, end - begin);
      for (size_t k = 0; k < n; ++k) sum[k] = (s > 0 ? sum[k] : 0) + stage.weight * velocity[k];
    }
    for (size_t k = 0; k < n; ++k) x[k] += at.h * sum[k];
  });
}

}  // namespace truestep::ode
