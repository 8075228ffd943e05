#include "server/cli/describe/examples.h"

namespace truestep {
namespace {

struct Example {
  std::string_view type, scene;
};

// clang-format off
constexpr Example kExamples[] = {
{"ode", R"json({"time": {"dt": 0.05, "duration": 20},
 "systems": [{"type": "ode", "id": "circuit", "states": {"x": 2}, "parameters": {"mu": 1}, "second": {"x": "mu*(1 - x^2)*x' - x"}}]}
)json"},
{"oscillator", R"json({"time": {"dt": 0.02, "duration": 10},
 "systems": [{"type": "oscillator", "id": "mass", "mass": 1, "stiffness": 4, "damping": 0.1}]}
)json"},
{"pendulum", R"json({"time": {"dt": 0.01, "duration": 10},
 "systems": [{"type": "pendulum", "id": "double", "links": 2, "lengths": [1, 1], "masses": [1, 1], "angles": [2, 2]}]}
)json"},
{"heat", R"json({"time": {"dt": 0.01, "duration": 1},
 "systems": [{"type": "heat", "id": "rod", "cells": [100], "size": [1], "diffusivity": 0.01, "initial": "exp(-100*(x - 0.5)^2)"}]}
)json"},
{"wave", R"json({"time": {"dt": 0.005, "duration": 2},
 "systems": [{"type": "wave", "id": "string", "cells": [200], "initial": "exp(-400*(x - 0.3)^2)"}]}
)json"},
{"grid_fluid", R"json({"time": {"dt": 0.05, "duration": 10},
 "systems": [{"type": "grid_fluid", "id": "cavity", "cells": [32, 32], "viscosity": 0.01, "sides": {"y_max": {"kind": "wall", "velocity": ["1", "0"]}}}]}
)json"},
{"heightfield_wave", R"json({"gravity": [0, 0, -9.81], "time": {"dt": 0.02, "duration": 5},
 "systems": [{"type": "heightfield_wave", "id": "pool", "cells": [64, 64], "size": [4, 4], "surface": "0.5 + 0.2*exp(-4*(x^2 + y^2))"}]}
)json"},
{"particles", R"json({"time": {"dt": 0.01, "duration": 2},
 "systems": [{"type": "particles", "id": "shots", "positions": [[0, 1, 0], [0, 1, 1]], "velocities": [[3, 4, 0], [3, 4, 0]], "linear_drag": 0.1}]}
)json"},
{"nbody", R"json({"time": {"dt": 0.01, "duration": 10}, "gravity": [0, 0, 0],
 "systems": [{"type": "nbody", "id": "stars", "gravitational_constant": 1, "masses": [1, 1], "positions": [[-0.5, 0, 0], [0.5, 0, 0]], "velocities": [[0, -0.7, 0], [0, 0.7, 0]]}]}
)json"},
{"flocking", R"json({"time": {"dt": 0.0333, "duration": 20},
 "systems": [{"type": "flocking", "id": "birds", "count": 100, "half_extents": [5, 5, 5], "sides": "periodic"}]}
)json"},
{"crowd", R"json({"time": {"dt": 0.0333, "duration": 20},
 "systems": [{"type": "crowd", "id": "people", "groups": [
   {"count": 10, "center": [-4, 0, 0], "half_extents": [2, 2, 0], "heading": [1, 0, 0]},
   {"count": 10, "center": [4, 0, 0], "half_extents": [2, 2, 0], "heading": [-1, 0, 0]}]}]}
)json"},
{"molecular", R"json({"time": {"dt": 0.004, "duration": 4}, "gravity": [0, 0, 0],
 "systems": [{"type": "molecular", "id": "atoms", "boltzmann": 1, "kinds": [{"name": "A", "mass": 1, "sigma": 1, "epsilon": 1}],
   "lattice": {"arrangement": "fcc", "cells": [4, 4, 4], "number_density": 0.8}, "temperature": 1, "cutoff": 2.5}]}
)json"},
{"mass_spring", R"json({"time": {"dt": 0.01, "duration": 5},
 "systems": [{"type": "mass_spring", "id": "rope", "rope": {"from": [0, 1, 0], "to": [1, 1, 0], "links": 20}, "mass": 0.01, "stiffness": 1000, "damping": 0.05, "pinned": ["first"]}]}
)json"},
{"xpbd", R"json({"time": {"dt": 0.0166667, "duration": 5},
 "systems": [{"type": "xpbd", "id": "cloth", "cloth_grid": {"origin": [0, 1, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1], "nx": 20, "ny": 20}, "density": 0.2, "stiffness": 1000, "pinned": ["edge_u0"]}]}
)json"},
{"fem", R"json({"time": {"dt": 0.01, "duration": 2},
 "systems": [{"type": "fem", "id": "beam", "block": {"size": [1, 0.1, 0.1], "cells_x": 10, "cells_y": 1, "cells_z": 1}, "density": 1000, "youngs_modulus": 1e6, "pinned": ["x0"]}]}
)json"},
{"mpm", R"json({"time": {"dt": 0.0166667, "duration": 2},
 "systems": [{"type": "mpm", "id": "jelly", "low": [0, 0, 0], "high": [1, 1, 1], "cell": 0.05, "bodies": [{"material": "corotated", "shape": "box", "center": [0.5, 0.5, 0.5], "half_extents": [0.15, 0.15, 0.15]}]}]}
)json"},
{"sph", R"json({"time": {"dt": 0.0166667, "duration": 2},
 "systems": [{"type": "sph", "id": "water", "low": [0, 0, 0], "high": [1, 1, 0.4], "spacing": 0.05, "bodies": [{"center": [0.2, 0.25, 0.2], "half_extents": [0.2, 0.25, 0.2]}]}]}
)json"},
{"articulation", R"json({"time": {"dt": 0.01, "duration": 5},
 "systems": [{"type": "articulation", "id": "arm", "links": [
   {"id": "upper", "joint": "revolute", "axis": [0, 0, 1], "q": [1], "mass": 1, "center": [0.5, 0, 0]},
   {"id": "lower", "parent": "upper", "joint": "revolute", "axis": [0, 0, 1], "offset": [1, 0, 0], "mass": 1, "center": [0.5, 0, 0]}]}]}
)json"},
{"rod_chain", R"json({"time": {"dt": 0.005, "duration": 5},
 "systems": [{"type": "rod_chain", "id": "chain", "links": 5, "length": 0.2, "direction": [1, 0, 0]}]}
)json"},
{"rigid2d", R"json({"time": {"dt": 0.0166667, "duration": 3},
 "systems": [{"type": "rigid2d", "id": "blocks", "bodies": [
   {"motion": "fixed", "position": [0, -0.5, 0], "shapes": [{"type": "box", "half_extents": [5, 0.5, 0]}]},
   {"position": [0, 2, 0], "angle": 0.3, "shapes": [{"type": "box", "half_extents": [0.5, 0.5, 0]}]}]}]}
)json"},
{"rigid3d", R"json({"time": {"dt": 0.0166667, "duration": 3},
 "systems": [{"type": "rigid3d", "id": "blocks", "bodies": [
   {"type": "plane", "motion": "fixed"},
   {"type": "box", "position": [0, 2, 0], "half_extents": [0.5, 0.5, 0.5]},
   {"type": "sphere", "position": [0.1, 4, 0], "radius": 0.5}]}]}
)json"},
{"keyframes", R"json({"time": {"dt": 0.0166667, "duration": 4},
 "systems": [{"type": "keyframes", "id": "fan", "shapes": [{"id": "blade", "shape": "box", "half_extents": [1, 0.1, 0.05], "position": ["0", "1", "0"], "rotation": ["0", "0", "2*t"]}]}]}
)json"},
{"skeleton", R"json({"time": {"dt": 0.0166667, "duration": 4},
 "systems": [{"type": "skeleton", "id": "arm", "joints": [
   {"id": "shoulder", "rotation": ["0", "0", "0.5*sin(2*t)"]},
   {"id": "elbow", "parent": "shoulder", "offset": [0.5, 0, 0], "rotation": ["0", "0", "sin(2*t)"]},
   {"id": "hand", "parent": "elbow", "offset": [0.4, 0, 0]}]}]}
)json"},
{"ik", R"json({"time": {"dt": 0.0166667, "duration": 4},
 "systems": [{"type": "ik", "id": "arm", "joints": [
   {"id": "shoulder"}, {"id": "elbow", "parent": "shoulder", "offset": [0.5, 0, 0]}, {"id": "hand", "parent": "elbow", "offset": [0.4, 0, 0]}],
   "goals": [{"joint": "hand", "target": ["0.5", "0.4*sin(t)", "0.1"]}]}]}
)json"},
{"motion_capture", R"json({"time": {"dt": 0.0166667, "duration": 1},
 "systems": [{"type": "motion_capture", "id": "arm", "motion": {"bvh": [
   "HIERARCHY", "ROOT shoulder", "{", "  OFFSET 0 0 0", "  CHANNELS 3 Zrotation Xrotation Yrotation", "  End Site", "  {", "    OFFSET 0.5 0 0", "  }", "}",
   "MOTION", "Frames: 3", "Frame Time: 0.5", "0 0 0", "60 0 0", "0 0 0"]}}]}
)json"},
{"blend_shapes", R"json({"time": {"dt": 0.0166667, "duration": 4},
 "systems": [{"type": "blend_shapes", "id": "face", "ball": {"radius": 0.5},
   "targets": [{"name": "tall", "weight": "0.5 + 0.5*sin(2*t)", "offset": ["0", "0.4*y", "0"]}]}]}
)json"},
{"contact", R"json({"time": {"dt": 0.0083333, "duration": 3},
 "systems": [
   {"type": "xpbd", "id": "cloth", "cloth_grid": {"origin": [-0.5, 1, -0.5], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1], "nx": 20, "ny": 20}, "density": 0.3, "thickness": 0.01},
   {"type": "rigid3d", "id": "ball", "bodies": [{"type": "sphere", "motion": "fixed", "radius": 0.3, "position": [0, 0.5, 0]}]}],
 "couplings": [{"type": "contact", "id": "touch", "a": "cloth", "b": "ball", "friction": 0.4}]}
)json"},
{"attachment", R"json({"time": {"dt": 0.0083333, "duration": 3},
 "systems": [
   {"type": "mass_spring", "id": "rope", "rope": {"from": [0, 2, 0], "to": [0, 1, 0], "links": 10}, "mass": 0.02, "stiffness": 2000, "damping": 0.2, "pinned": ["first"]},
   {"type": "rigid3d", "id": "crate", "bodies": [{"type": "box", "half_extents": [0.1, 0.1, 0.1], "mass": 0.2, "position": [0, 0.9, 0], "velocity": [0.5, 0, 0]}]}],
 "couplings": [{"type": "attachment", "id": "hook", "a": "rope", "b": "crate", "a_points": [-1], "b_points": [0], "places": [[0, 1, 0]], "stiffness": 2000, "damping": 0.5}]}
)json"},
{"drive", R"json({"time": {"dt": 0.0083333, "duration": 3},
 "systems": [
   {"type": "keyframes", "id": "hand", "paths": [{"name": "sway", "times": [0, 1, 2, 3], "points": [[0, 1, 0], [0.5, 1, 0], [-0.5, 1, 0], [0, 1, 0]]}]},
   {"type": "rigid3d", "id": "tray", "bodies": [{"type": "box", "motion": "kinematic", "half_extents": [0.4, 0.05, 0.4], "position": [0, 1, 0]}, {"type": "sphere", "radius": 0.1, "position": [0, 1.15, 0]}]}],
 "couplings": [{"type": "drive", "id": "carry", "a": "hand", "b": "tray", "path": "sway", "body": 0}]}
)json"},
{"immersion", R"json({"time": {"dt": 0.0083333, "duration": 2},
 "systems": [
   {"type": "rigid3d", "id": "ball", "bodies": [{"type": "sphere", "radius": 0.08, "density": 300, "position": [0.2, 0.4, 0.2]}]},
   {"type": "sph", "id": "water", "low": [0, 0, 0], "high": [0.4, 0.6, 0.4], "spacing": 0.04, "bodies": [{"center": [0.2, 0.1, 0.2], "half_extents": [0.2, 0.1, 0.2]}]}],
 "couplings": [{"type": "immersion", "id": "float", "a": "ball", "b": "water"}]}
)json"},
{"ragdoll", R"json({"time": {"dt": 0.0083333, "duration": 3},
 "systems": [
   {"type": "skeleton", "id": "arm", "root_position": ["0", "2", "0"], "joints": [{"id": "shoulder", "rotation": ["0", "0", "1"]}, {"id": "elbow", "parent": "shoulder", "offset": [0.5, 0, 0], "end": [0.4, 0, 0]}]},
   {"type": "rigid3d", "id": "bones", "bodies": [
     {"type": "capsule", "radius": 0.06, "half_length": 0.2, "position": [0, 2, 0]},
     {"type": "capsule", "radius": 0.06, "half_length": 0.15, "position": [0.5, 2, 0]},
     {"type": "plane", "motion": "fixed"}],
    "joints": [{"type": "spherical", "a": 0, "b": 1, "anchor": [0.27, 2.42, 0]}]}],
 "couplings": [{"type": "ragdoll", "id": "falls", "a": "arm", "b": "bones", "bones": [0, 1], "bodies": [0, 1], "at": 0.5}]}
)json"},
};
// clang-format on

}  // namespace

std::string_view example_of(std::string_view type) {
  for (const Example& e : kExamples) {
    if (e.type == type) return e.scene;
  }
  return {};
}

}  // namespace truestep
