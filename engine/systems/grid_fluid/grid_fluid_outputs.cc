// Descriptions of a flow's fields and observables.
#include "engine/systems/grid_fluid/grid_fluid_def.h"

namespace truestep::grid_fluid {

const Outputs& grid_fluid_outputs() {
  static const Outputs kOutputs{
      .rows = "a cell, x fastest; of a liquid a particle",
      .fields = {{"velocity", "m/s", 3, "velocity at the cell's centre"},
                 {"speed", "m/s", 1, "its magnitude"},
                 {"pressure", "Pa", 1, "pressure"},
                 {"vorticity", "1/s", 1,
                  "curl of the velocity: along z in the plane, its magnitude in space"},
                 {"scalar", "1", 1, "what the flow carries"},
                 {"second_fluid", "1", 1, "fraction of a cell filled by the second fluid"},
                 {"fill", "1", 1, "of a liquid: fraction of the particle's cell that is filled"},
                 {"position", "m", 3, "of a liquid's particle"},
                 {"dye", "1", 1, "of a liquid's particle, if bodies, emitters or sides set one"},
                 {"id", "1", 1, "of a liquid's particle where they come and go: never reused"}},
      .observables = {
          {"energy.kinetic", "J", "of the fluid in the box"},
          {"enstrophy", "1/s^2", "half the square of the vorticity, integrated over the box"},
          {"divergence.max", "1/s", "largest divergence of a cell"},
          {"speed.max", "m/s", "largest component of the velocity on a face"},
          {"cfl", "1", "cells crossed in a substep by whatever is fastest"},
          {"substeps", "1", "substeps of the last step"},
          {"pressure.iterations", "1", "iterations of the last pressure solve; 0: solved directly"},
          {"pressure.residual", "1", "relative residual after that solve"},
          {"steady.iterations", "1", "iterations that found a steady flow, on the scene's own grid"},
          {"steady.change", "1", "change of its velocity in the last of them, relative to the largest"},
          {"scalar.total", "1", "integral of what the flow carries"},
          {"second_fluid.volume", "m^3", "volume of the second fluid (area in the plane)"},
          {"obstacle.drag", "N", "force of the fluid on the obstacles along x, mean over the last substep"},
          {"obstacle.lift", "N", "the same along y"},
          {"obstacle.torque", "N m",
           "with rotating obstacles: sum of the fluid's torques on each about its axis"},
          {"energy.gravity", "J", "of a liquid or two fluids: potential, about the origin"},
          {"energy.total", "J", "of a liquid: its sum with the kinetic energy"},
          {"momentum.x", "kg m/s", "of a liquid"},
          {"momentum.y", "kg m/s", ""},
          {"momentum.z", "kg m/s", ""},
          {"centre.x", "m", "of a liquid's mass"},
          {"centre.y", "m", ""},
          {"centre.z", "m", ""},
          {"low.x", "m", "smallest coordinate of a liquid's particles"},
          {"low.y", "m", ""},
          {"low.z", "m", ""},
          {"high.x", "m", "largest coordinate of a liquid's particles"},
          {"high.y", "m", ""},
          {"high.z", "m", ""},
          {"mass", "kg",
           "of the fluid between obstacles, in the plane per metre across; of a liquid's particles"},
          {"density.mean_error", "1", "of a liquid: mean compression of its cells in the last substep"},
          {"density.max_error", "1", "the largest"},
          {"density.iterations", "1", "iterations of the solve that undoes compression"},
          {"density.lift", "J",
           "by which undoing compression has lifted a liquid since the start; taken from its motion"},
          {"dye.total", "1", "integral of the dye over a liquid"},
          {"count", "1", "particles of a liquid present, if they come or go"},
          {"emitted", "1", "particles that came in through nozzles and sides"},
          {"killed", "1", "particles removed by kill regions"},
          {"left", "1", "particles that left through open sides"},
          {"refused", "1", "particles refused because max_particles was reached"},
          {"error.exact", "m/s", "difference from the scene's exact velocity, root mean square"}}};
  return kOutputs;
}

}  // namespace truestep::grid_fluid
