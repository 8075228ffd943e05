// Exports a skeleton or a blended surface to files of other programs: BVH (joints only) or glTF 2.0 (joints,
// skin with its weights, targets, and their motion), collected frame by frame.
#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/state/state.h"
#include "engine/core/system.h"
#include "engine/geometry/shape.h"

namespace truestep {

class MotionExport {
 public:
  /// For a system with a skeleton or targets; Error "unsuitable_system" otherwise. `rate`: frames per second.
  MotionExport(const System& system, std::string name, double rate);
  static bool suits(const System& system);
  /// Rows of data per frame: the joints, or the surface itself and its targets.
  static size_t rows(const System& system);

  void add(const State& state, double t);
  size_t frames() const { return frames_; }

  /// Lines with their line ends; lengths in m. Error "unsuitable_system" without a skeleton.
  std::string bvh() const;
  /// A .glb, and a .gltf with embedded data.
  std::string glb() const;
  std::string gltf() const;

 private:
  struct Document;
  Document document() const;
  void add_skeleton(Document& d) const;
  void add_surface(Document& d) const;

  const System& system_;
  std::string name_;
  double rate_;
  size_t frames_ = 0;
  std::vector<Pose> locals_;     ///< frames x joints, each in its parent's frame; for a surface frames x 1
  std::vector<double> weights_;  ///< frames x targets
};

}  // namespace truestep
