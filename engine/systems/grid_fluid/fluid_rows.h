// What flows and liquids on a grid measure: one list of observables for the type, of which each has its own.
#pragma once
#include <array>
#include <optional>

#include "engine/core/outputs/outputs_of.h"

namespace truestep::grid_fluid {

/// Those that a system does not have are empty.
struct FluidNumbers {
  using Maybe = std::optional<double>;
  double kinetic = 0, fastest = 0, cfl = 0, substeps = 0, mass = 0;
  Maybe enstrophy = {}, divergence = {}, pressure_iterations = {}, pressure_residual = {};
  Maybe steady_iterations = {}, steady_change = {}, scalar = {}, second_volume = {};
  Maybe drag = {}, lift = {}, torque = {}, gravity = {}, energy = {};
  std::optional<Vec3> momentum = {}, centre = {}, low = {}, high = {};
  Maybe mean_compression = {}, max_compression = {}, lifted = {}, density_iterations = {}, dye = {};
  Maybe count = {}, emitted = {}, killed = {}, left = {}, refused = {}, error = {};
};

inline constexpr auto kFluidRows = [] {
  using N = FluidNumbers;
  return std::to_array<Measured<N>>({
      {"energy.kinetic", "J", &N::kinetic, "of the fluid in the box"},
      {"enstrophy", "1/s^2", &N::enstrophy, "half the square of the vorticity, integrated over the box"},
      {"divergence.max", "1/s", &N::divergence, "largest divergence of a cell"},
      {"speed.max", "m/s", &N::fastest, "largest component of the velocity on a face"},
      {"cfl", "1", &N::cfl, "cells crossed in a substep by whatever is fastest"},
      {"substeps", "1", &N::substeps, "substeps of the last step"},
      {"pressure.iterations", "1", &N::pressure_iterations,
       "iterations of the last pressure solve; 0: solved directly"},
      {"pressure.residual", "1", &N::pressure_residual, "relative residual after that solve"},
      {"steady.iterations", "1", &N::steady_iterations,
       "iterations that found a steady flow, on the scene's own grid"},
      {"steady.change", "1", &N::steady_change,
       "change of its velocity in the last of them, relative to the largest"},
      {"scalar.total", "1", &N::scalar, "integral of what the flow carries"},
      {"second_fluid.volume", "m^3", &N::second_volume, "volume of the second fluid (area in the plane)"},
      {"obstacle.drag", "N", &N::drag,
       "force of the fluid on the obstacles along x, mean over the last substep"},
      {"obstacle.lift", "N", &N::lift, "the same along y"},
      {"obstacle.torque", "N m", &N::torque,
       "with rotating obstacles: sum of the fluid's torques on each about its axis"},
      {"energy.gravity", "J", &N::gravity, "of a liquid or two fluids: potential, about the origin"},
      {"energy.total", "J", &N::energy, "of a liquid: its sum with the kinetic energy"},
      {"momentum", "kg m/s", &N::momentum, "of a liquid"},
      {"centre", "m", &N::centre, "of a liquid's mass"},
      {"low", "m", &N::low, "smallest coordinate of a liquid's particles"},
      {"high", "m", &N::high, "largest coordinate of a liquid's particles"},
      {"mass", "kg", &N::mass,
       "of the fluid between obstacles, in the plane per metre across; of a liquid's particles"},
      {"density.mean_error", "1", &N::mean_compression,
       "of a liquid: mean compression of its cells in the last substep"},
      {"density.max_error", "1", &N::max_compression, "the largest"},
      {"density.lift", "J", &N::lifted,
       "by how much undoing compression has lifted the liquid since the start; taken from its motion"},
      {"density.iterations", "1", &N::density_iterations, "iterations of the solve that undoes compression"},
      {"dye.total", "1", &N::dye, "integral of the dye over a liquid"},
      {"count", "1", &N::count, "particles of a liquid present, if they come or go"},
      {"emitted", "1", &N::emitted, "particles that came in through nozzles and sides"},
      {"killed", "1", &N::killed, "particles removed by kill regions"},
      {"left", "1", &N::left, "particles that left through open sides"},
      {"refused", "1", &N::refused, "particles refused because max_particles was reached"},
      {"error.exact", "m/s", &N::error, "difference from the scene's exact velocity, root mean square"},
  });
}();

}  // namespace truestep::grid_fluid
