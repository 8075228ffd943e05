#include "engine/scene/catalogue.h"

#include "engine/reference/engines.h"
#include "engine/systems/articulation/articulation_def.h"
#include "engine/systems/fem/fem.h"
#include "engine/systems/heat/heat.h"
#include "engine/systems/mass_spring/mass_spring.h"
#include "engine/systems/mpm/mpm.h"
#include "engine/systems/ode/ode.h"
#include "engine/systems/oscillator/oscillator.h"
#include "engine/systems/particles/particles.h"
#include "engine/systems/pendulum/pendulum.h"
#include "engine/systems/rigid2d/rigid2d.h"
#include "engine/systems/rigid3d/rigid3d_def.h"
#include "engine/systems/rod_chain/rod_chain.h"
#include "engine/systems/wave/wave.h"
#include "engine/systems/xpbd/xpbd.h"

namespace truestep {

std::span<const CatalogueRow> catalogue() {
  static const std::vector<CatalogueRow> kRows = {
      {"ode",
       "equations",
       "named states, parameters and right-hand sides as expressions, with events; tracers in a velocity "
       "field",
       &ode::ode_table(),
       ode::make_ode,
       ode::ode_cost,
       {"equations compile to a small multiple of the time of C++", "the same bits on any number of threads",
        "events are located on the method's interpolant, not at steps",
        "texts cannot loop, allocate without bound or touch the machine"},
       "tsit5",
       &ode::ode_outputs(),
       1e13},
      {"oscillator",
       "equations",
       "a damped, driven mass on a spring with its exact solution",
       &oscillator::oscillator_table(),
       oscillator::make_oscillator,
       oscillator::cost_oscillator,
       {"every integrator shows its order on it", "the amplitude per step is the method's own, to 1e-12"},
       "rk4",
       &oscillator::oscillator_outputs()},
      {"pendulum",
       "equations",
       "a chain of point masses on rigid rods that swings in a plane",
       &pendulum::pendulum_table(),
       pendulum::make_pendulum,
       pendulum::cost_pendulum,
       {"follows the published simple and double pendulum to 1e-8", "keeps its energy when undamped"},
       "dop853",
       &pendulum::pendulum_outputs()},
      {"heat",
       "fields",
       "heat conduction in a box of one to three dimensions, with sources and sides of four kinds",
       &heat::heat_table(),
       heat::build_heat,
       heat::heat_cost,
       {"order 2 or 4 in space and the method's own in time", "an insulated box keeps its heat to rounding",
        "the same bits on any number of threads"},
       "rk4",
       &heat::heat_outputs(),
       1e13,
       &lattice::resolution<heat::HeatDef>()},
      {"wave",
       "fields",
       "waves in a box of one to three dimensions: strings, membranes, ponds, sound",
       &wave::wave_table(),
       wave::build_wave,
       wave::wave_cost,
       {"order 2 or 4 in space and the method's own in time",
        "symplectic methods keep the energy without drift", "the same bits on any number of threads"},
       "leapfrog",
       &wave::wave_outputs(),
       1e13,
       &lattice::resolution<wave::WaveDef>()},
      {"particles",
       "points",
       "points with emitters, lifetimes, forces and obstacles",
       &particles::particles_table(),
       particles::build_particles,
       particles::particles_cost,
       {"a birth is a function of seed, emitter and number alone, at its exact time between steps",
        "no point passes a collider, however thin or fast", "points at rest stay at rest to the bit"},
       "leapfrog",
       &particles::particles_outputs()},
      {"mass_spring",
       "springs",
       "points joined by springs: ropes, hair, cloth on a grid or a mesh, free networks",
       &mass_spring::mass_spring_table(),
       mass_spring::build_mass_spring,
       mass_spring::mass_spring_cost,
       {"force is minus the gradient of the potential", "springs and their damping conserve momentum",
        "pinned points do not move", "the same bits on any number of threads"},
       "linear_implicit_euler",
       &mass_spring::mass_spring_outputs(),
       10,
       &mass_spring::mass_spring_resolution()},
      {"xpbd",
       "springs",
       "cloth, ropes, hair and soft blocks by position-based dynamics, with the stiffness of the scene "
       "(xpbd) or "
       "the textbook's (pbd)",
       &xpbd::xpbd_table(),
       xpbd::build_xpbd,
       xpbd::xpbd_cost,
       {"the stretch of a hanging rope is m g / k, whatever the step", "pinned points do not move",
        "constraints conserve momentum", "the same bits on any number of threads"},
       "",
       &xpbd::xpbd_outputs()},
      {"fem",
       "solids",
       "elastic bodies of finite elements, in space and in the plane, moving or in equilibrium",
       &fem::fem_table(),
       fem::build_fem,
       fem::fem_cost,
       {"affine displacements are exact on any mesh",
        "nearly incompressible bodies do not lock (volume mean)", "an inverted element turns back",
        "the same bits on any number of threads"},
       "implicit_euler",
       &fem::fem_outputs()},
      {"mpm",
       "solids",
       "snow, sand, water, jelly and foam by the material point method, in space and in the plane",
       &mpm::mpm_table(),
       mpm::build_mpm,
       mpm::mpm_cost,
       {"affine transfers conserve momentum and angular momentum to rounding",
        "substeps follow the fastest particle or wave", "empty space costs nothing",
        "the same bits on any number of threads"},
       "",
       &mpm::mpm_outputs()},
      {"articulation",
       "rigid bodies",
       "rigid links in a tree of joints, in the joints' own coordinates: chains that cannot come apart, "
       "loops",
       &articulation::articulation_table(),
       articulation::build_articulation,
       articulation::articulation_cost,
       {"joints have no gap, loops one of rounding", "follows the published pendulums, tops and linkages",
        "accelerations solve M q'' + h = tau to 1e-12", "a step costs O(links)"},
       "dop853",
       &articulation::articulation_outputs()},
      {"rod_chain",
       "rigid bodies",
       "thin rigid rods joined end to end, the joints kept by penalty, projection or Lagrange multipliers",
       &rod_chain::rod_chain_table(),
       rod_chain::build_rod_chain,
       rod_chain::rod_chain_cost,
       {"multipliers and projection leave a gap of rounding, springs one of force / stiffness",
        "multipliers keep the energy to fourth order of the step", "a step costs O(rods)"},
       "",
       &rod_chain::rod_chain_outputs()},
      {"rigid2d",
       "rigid bodies",
       "rigid bodies in the plane with contacts, friction, sleeping and nine kinds of joints",
       &rigid2d::rigid2d_table(),
       build_rigid2d_engine,
       rigid2d::rigid2d_cost,
       {"nothing catches on the corners of a chain", "fast bodies do not pass thin walls",
        "a stack of 20 boxes stands", "the same bits on any number of threads and after a restore"},
       "",
       &rigid2d::rigid2d_outputs()},
      {"rigid3d",
       "rigid bodies",
       "rigid bodies of any shape that touch, slide, roll, bounce, stack and sleep",
       &rigid3d::rigid3d_table(),
       build_rigid3d_engine,
       rigid3d::rigid3d_cost,
       {"a free body keeps its angular momentum and turns with fourth order",
        "no body passes another, however thin or fast", "the same bits on any number of threads",
        "a restored snapshot continues in the middle of a collapse"},
       "",
       &rigid3d::rigid3d_outputs()},
  };
  return kRows;
}

const CatalogueRow* find_system_type(std::string_view type) {
  for (const CatalogueRow& row : catalogue()) {
    if (row.type == type) return &row;
  }
  return nullptr;
}

}  // namespace truestep
