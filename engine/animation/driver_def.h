// The inputs of an animation as a scene writes them: controls (numbers by expression or keys), paths
// (positions through keys), vectors (any number of numbers through keys) and turns (orientations through
// keys). Joints, shapes and weights are expressions of t and of these names; a path p gives p_x, p_y and p_z,
// a vector v gives v_0, v_1 and so on. Shared by keyframes, skeleton and blend_shapes.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/core/def/def.h"
#include "engine/kernels/animation/rotations.h"

namespace truestep::animation {

/// A named number: keys, or an expression of t and of the names before it.
struct ControlDef {
  std::string name, value;
  std::vector<double> times, values, slopes_in, slopes_out, handles;
  Interpolation interpolation = Interpolation::catmull_rom;
  Extend extend = Extend::clamp;
};

/// A curve in space.
struct PathDef {
  std::string name;
  std::vector<double> times;
  std::vector<Vec3> points;
  Interpolation interpolation = Interpolation::catmull_rom;
  Extend extend = Extend::clamp;
  bool even_speed = false;
};

/// Numbers that go from key to key together.
struct VectorDef {
  std::string name;
  std::vector<double> times, values, slopes_in, slopes_out, handles;  ///< values, slopes: keys x width
  Interpolation interpolation = Interpolation::catmull_rom;
  Extend extend = Extend::clamp;
  size_t width() const { return values.size() / times.size(); }
};

/// Orientations at times.
struct TurnDef {
  std::string name;
  std::vector<double> times, quaternions;  ///< n x 4, w x y z
  Turning interpolation = Turning::slerp;
  Extend extend = Extend::clamp;
};

struct DriverDef {
  std::vector<ControlDef> controls;
  std::vector<PathDef> paths;
  std::vector<VectorDef> vectors;
  std::vector<TurnDef> turns;
  std::optional<double> frame_rate;
};

/// Euler angles, the first named axis first, each about the axis as already turned.
enum class EulerOrder : uint8_t { xyz, xzy, yxz, yzx, zxy, zyx };
inline const std::vector<std::string> kEulerOrders{"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"};
Quat euler_rotation(EulerOrder order, const Vec3& angles);

const DefTable& control_table();
const DefTable& path_table();
const DefTable& vector_table();
const DefTable& turn_table();

/// Rows of DriverDef, for the table of a struct that derives from it.
template <class D>
void add_driver_rows(TableOf<D>& table) {
  table
      .objects("controls", static_cast<std::vector<ControlDef> D::*>(&D::controls), control_table(),
               {0, 10'000}, "named numbers that expressions use and commands set")
      .objects("paths", static_cast<std::vector<PathDef> D::*>(&D::paths), path_table(), {0, 1000},
               "curves in space; expressions see <name>_x, <name>_y and <name>_z")
      .objects("vectors", static_cast<std::vector<VectorDef> D::*>(&D::vectors), vector_table(), {0, 1000},
               "lists of numbers through keys; expressions see <name>_0, <name>_1 and so on")
      .objects("turns", static_cast<std::vector<TurnDef> D::*>(&D::turns), turn_table(), {0, 1000},
               "orientations through keys")
      .number("frame_rate", static_cast<std::optional<double> D::*>(&D::frame_rate), "1/s", above(0),
              "poses are held between frames of this rate; absent: every step has its own");
}

}  // namespace truestep::animation
