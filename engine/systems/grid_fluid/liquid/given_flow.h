// Where liquid enters the box, and with which velocity: sides of kind inflow, and nozzles. Faces on such
// sides and within a nozzle are closed to the pressure and hold the given velocity. What a nozzle emits
// appears in the cells of its rear half, as a source of the same volume per second as that of its particles.
// Scratch of one thread's run.
#pragma once
#include <span>
#include <vector>

#include "engine/systems/grid_fluid/flow.h"
#include "engine/systems/grid_fluid/liquid/inlet.h"

namespace truestep::grid_fluid {

class GivenFlow {
 public:
  /// `inlets` must outlive it.
  void bind(const FlowModel& model, std::span<const LiquidInlet> inlets);
  /// For time t (s); `pours`: whether there is room for more particles.
  enum class Room : uint8_t { left, none };
  void place(double t, Room room);
  bool any() const { return !inlets_.empty() || !sides_.empty(); }
  /// Sets component c of the given velocities, and the weights of those faces to zero.
  void hold(size_t c, double* u) const;
  void mark(size_t c, uint8_t* known) const;
  void shut(size_t c, double* factor) const;
  /// div (1/s) -= sources, in cells of liquid.
  void take_sources(const uint8_t* liquid, double* divergence) const;
  /// The velocity (m/s) of the nozzle that holds a point (m) now; null: none does.
  const LiquidInlet* holder(const Vec3& at) const;
  /// Cells per second crossed by the fastest of them, summed over the axes.
  double crossing_rate() const;

  /// A side of kind inflow.
  struct Side {
    size_t axis, end;
    std::vector<double> normal;  ///< m/s along the axis, over the padded plane of the other two
    double inwards(size_t plane) const { return end == 0 ? normal[plane] : -normal[plane]; }
  };
  std::span<const Side> sides() const { return sides_; }

 private:
  struct Source {
    uint32_t cell;
    double rate;  ///< 1/s
  };
  struct Pipe {
    std::array<std::vector<uint32_t>, 3> faces;
    std::vector<Source> sources;
  };
  void find_pipe(const LiquidInlet& inlet, Pipe& pipe) const;
  template <class F>
  void for_faces(size_t c, F&& f) const;

  const FlowModel* model_ = nullptr;
  std::span<const LiquidInlet> inlets_;
  std::vector<Pipe> pipes_;
  std::vector<Side> sides_;
  double time_ = 0;
  Room room_ = Room::left;
  bool sampled_ = false;
};

}  // namespace truestep::grid_fluid
