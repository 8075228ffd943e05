// The obstacles of a flow at a time: geometry (solids.h) and the velocity of their walls. If the scene moves
// none of them, nothing is computed twice. Scratch of one thread's run.
#pragma once
#include "engine/systems/grid_fluid/flow_texts.h"
#include "engine/systems/grid_fluid/solids.h"

namespace truestep::grid_fluid {

struct FlowModel;

class MovingSolids {
 public:
  /// Places obstacles for t = 0 and reserves memory for other poses.
  void bind(const FlowModel& model);
  /// Places obstacles for time t (s); returns whether they moved.
  bool place(double t);

  const Solids* operator->() const { return solids_; }
  const Solids& operator*() const { return *solids_; }
  const std::vector<ObstacleDef>& obstacles() const { return places_.obstacles; }
  /// m/s, of an obstacle's material at a point (m), and component c of it at the centre of a face.
  Vec3 velocity(uint32_t obstacle, const Vec3& at) const;
  double velocity(const Solids::Face& face, size_t c) const;
  /// Cells per second crossed by the fastest wall, summed over the axes.
  double crossing_rate() const;
  /// N m per unit force along component c on a face, about the obstacle's axis.
  double lever(const Solids::Face& face, size_t c) const;

 private:
  const FlowModel* model_ = nullptr;
  const Solids* solids_ = nullptr;  ///< the model's, or `moving_`
  Solids moving_;
  ObstaclePlaces places_;
  double time_ = 0;  ///< s, for which `moving_` is placed
};

}  // namespace truestep::grid_fluid
