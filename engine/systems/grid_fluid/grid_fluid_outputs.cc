// Descriptions of a flow's fields and observables.
#include "engine/systems/grid_fluid/grid_fluid_def.h"

namespace truestep::grid_fluid {

const Outputs& grid_fluid_outputs() {
  static const Outputs kOutputs{
      .rows = "a cell, x running fastest; of a liquid a particle",
      .fields = {{"velocity", "m/s", 3, "velocity in the cell's centre"},
                 {"speed", "m/s", 1, "its magnitude"},
                 {"pressure", "Pa", 1, "pressure"},
                 {"vorticity", "1/s", 1,
                  "curl of the velocity: along z in the plane, its magnitude in space"},
                 {"scalar", "1", 1, "what the flow carries"},
                 {"second_fluid", "1", 1, "share of a cell that the second fluid fills"},
                 {"fill", "1", 1, "of a liquid: what of the cell around the particle it fills"},
                 {"position", "m", 3, "of a liquid's particle"}},
      .observables = {
          {"energy.kinetic", "J", "of the fluid in the box"},
          {"enstrophy", "1/s^2", "half the square of the vorticity, integrated over the box"},
          {"divergence.max", "1/s", "largest divergence of a cell"},
          {"speed.max", "m/s", "largest component of the velocity on a face"},
          {"cfl", "1", "cells that the fastest crosses in a substep"},
          {"substeps", "1", "substeps of the last step"},
          {"pressure.iterations", "1", "of the last substep's last solve; 0: solved directly"},
          {"pressure.residual", "1", "what is left of the right-hand side then"},
          {"steady.iterations", "1", "that a steady flow was found in, on the scene's own grid"},
          {"steady.change", "1", "of its velocity by the last of them, beside the fastest"},
          {"scalar.total", "1", "integral of what the flow carries"},
          {"second_fluid.volume", "m^3", "of the second fluid (area in the plane)"},
          {"obstacle.drag", "N", "force of the fluid on the obstacles along x, over the last substep"},
          {"obstacle.lift", "N", "the same along y"},
          {"obstacle.torque", "N m", "where obstacles turn: of the fluid on each about its axis, added up"},
          {"energy.gravity", "J", "of a liquid or two fluids: potential, about the origin"},
          {"energy.total", "J", "of a liquid: its sum with the kinetic energy"},
          {"momentum.x", "kg m/s", "of a liquid"},
          {"momentum.y", "kg m/s", ""},
          {"momentum.z", "kg m/s", ""},
          {"centre.x", "m", "of a liquid's mass"},
          {"centre.y", "m", ""},
          {"centre.z", "m", ""},
          {"low.x", "m", "least coordinate of a liquid's particles"},
          {"low.y", "m", ""},
          {"low.z", "m", ""},
          {"high.x", "m", "greatest coordinate of a liquid's particles"},
          {"high.y", "m", ""},
          {"high.z", "m", ""},
          {"mass", "kg", "of all particles of a liquid"},
          {"density.mean_error", "1", "of a liquid: mean compression of its cells in the last substep"},
          {"density.max_error", "1", "the largest"},
          {"density.iterations", "1", "of the solve that takes it back"},
          {"error.exact", "m/s", "distance from the scene's exact velocity, root mean square"}}};
  return kOutputs;
}

}  // namespace truestep::grid_fluid
