#include "engine/base/text/other_words.h"

#include <array>

namespace truestep {
namespace {

struct Row {
  std::string_view word;
  std::array<std::string_view, 3> names;
};

constexpr Row kRows[] = {
    // methods
    {"explicit_euler", {"euler"}},
    {"forward_euler", {"euler"}},
    {"backward_euler", {"implicit_euler"}},
    {"semi_implicit_euler", {"symplectic_euler"}},
    {"euler_cromer", {"symplectic_euler"}},
    {"stormer_verlet", {"velocity_verlet", "verlet"}},
    {"runge_kutta", {"rk4"}},
    {"runge_kutta4", {"rk4"}},
    {"runge_kutta_4", {"rk4"}},
    {"RK4", {"rk4"}},
    {"rk45", {"dopri5"}},
    {"RK45", {"dopri5"}},
    {"ode45", {"dopri5"}},
    {"runge_kutta45", {"dopri5"}},
    {"dormand_prince", {"dopri5"}},
    {"rk23", {"bs32"}},
    {"ode23", {"bs32"}},
    {"bdf", {"bdf2", "cvode_bdf"}},
    {"ode15s", {"cvode_bdf"}},
    {"radau", {"radau5"}},
    {"crank_nicolson", {"trapezoid"}},
    {"adams", {"cvode_adams"}},
    // kinds of systems
    {"cloth", {"xpbd", "mass_spring"}},
    {"rope", {"xpbd", "mass_spring"}},
    {"hair", {"xpbd", "mass_spring"}},
    {"spring", {"mass_spring"}},
    {"springs", {"mass_spring"}},
    {"soft_body", {"fem", "xpbd"}},
    {"softbody", {"fem", "xpbd"}},
    {"jelly", {"fem", "xpbd"}},
    {"elastic", {"fem"}},
    {"rigid", {"rigid3d", "rigid2d"}},
    {"rigid_body", {"rigid3d", "rigid2d"}},
    {"rigid_bodies", {"rigid3d", "rigid2d"}},
    {"bodies", {"rigid3d", "rigid2d"}},
    {"fluid", {"sph", "grid_fluid"}},
    {"water", {"sph", "grid_fluid", "heightfield_wave"}},
    {"liquid", {"sph", "grid_fluid"}},
    {"smoke", {"grid_fluid"}},
    {"snow", {"mpm"}},
    {"sand", {"mpm"}},
    {"boids", {"flocking"}},
    {"flock", {"flocking"}},
    {"pedestrians", {"crowd"}},
    {"gravity", {"nbody"}},
    {"planets", {"nbody"}},
    {"robot", {"articulation"}},
    {"multibody", {"articulation"}},
    {"equations", {"ode"}},
    {"shallow_water", {"heightfield_wave"}},
    {"collision", {"contact"}},
    // shapes and parameters
    {"ball", {"sphere", "circle"}},
    {"cube", {"box"}},
    {"cuboid", {"box"}},
    {"rectangle", {"box"}},
    {"disc", {"circle"}},
    {"disk", {"circle"}},
    {"static", {"fixed"}},
    {"pos", {"position"}},
    {"vel", {"velocity"}},
    {"bounciness", {"restitution"}},
    {"elasticity", {"restitution"}},
    {"timestep", {"dt"}},
    {"time_step", {"dt"}},
    {"method", {"integrator"}},
    {"solver", {"integrator"}},
};

}  // namespace

std::span<const std::string_view> names_for(std::string_view word) {
  for (const Row& row : kRows) {
    if (row.word != word) continue;
    size_t n = 0;
    while (n < row.names.size() && !row.names[n].empty()) ++n;
    return {row.names.data(), n};
  }
  return {};
}

}  // namespace truestep
