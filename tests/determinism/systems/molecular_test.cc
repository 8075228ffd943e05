// Atoms give the same bits on any number of threads, without a workspace, and from a copy of a state halfway
// between two neighbour lists; particle_allocation_test.cc checks that no step after the first allocates.
#include "tests/unit/particles/molecular_rig.h"

namespace truestep::molecular {
namespace {

using testing_rig::AtomRun;
using testing_rig::liquid;
using Method = ThermostatDef::Method;

/// Every thermostat, and one with a box that changes.
std::vector<MolecularDef> cases() {
  std::vector<MolecularDef> out{liquid(6)};
  for (const Method m : {Method::velocity_rescaling, Method::langevin, Method::nose_hoover}) {
    out.push_back(liquid(6));
    out.back().thermostat.emplace();
    out.back().thermostat->method = m, out.back().thermostat->temperature = 1,
    out.back().thermostat->time = 0.1;
  }
  out.push_back(out[1]);
  out.back().barostat.emplace();
  out.back().barostat->pressure = 1, out.back().barostat->time = 1,
  out.back().barostat->compressibility = 0.1;
  out.push_back(liquid(6));
  out.back().sides = Sides::open, out.back().integrator = "yoshida4";
  // Rigid water with friction, noise and Ewald's sum.
  MolecularDef w;
  KindDef o, h;
  o.name = "O", o.mass = 16, o.sigma = 0.3166, o.epsilon = 0.65, o.charge = -0.8476;
  h.name = "H", h.mass = 1, h.charge = 0.4238;
  w.kinds = {o, h}, w.water.emplace();
  w.water->cells = {4, 4, 4}, w.water->spacing = 3.107, w.water->length = 1;
  w.kinds[0].sigma = 3.166, w.box = Vec3{12.43, 12.43, 12.43}, w.cutoff = 5, w.skin = 0.05;
  w.boltzmann = 0.83, w.coulomb_constant = 1389, w.coulomb = Coulomb::ewald, w.temperature = 300;
  w.thermostat.emplace();
  w.thermostat->method = Method::langevin;
  w.thermostat->time = 0.1;
  out.push_back(w);
  return out;
}

TEST(MolecularDeterminism, AnyNumberOfThreadsGivesTheSameBits) {
  for (const MolecularDef& d : cases()) {
    AtomRun one(d, 0.005, 1), four(d, 0.005, 4), other(d, 0.0051, 1);
    one.step(40), four.step(40), other.step(40);
    EXPECT_EQ(one.state.hash(), four.state.hash());
    EXPECT_NE(one.state.hash(), other.state.hash());
  }
}

TEST(MolecularDeterminism, AStateIsAllThatAStepNeeds) {
  for (const MolecularDef& d : cases()) {
    for (const uint64_t at : {3, 17, 26}) {
      AtomRun run(d, 0.005), copy(d, 0.005);
      run.step(at);
      copy.state = State::deserialize(run.state.serialize()), copy.steps = run.steps;
      run.step(20), copy.step(10);
      copy.workspace.clear();
      copy.step(10);
      EXPECT_EQ(run.state.hash(), copy.state.hash()) << at;
    }
  }
}

TEST(MolecularDeterminism, ListsAreRenewed) {
  // Control of the above: within these steps the reference positions do change.
  AtomRun run(liquid(6), 0.005);
  run.step(3);
  const State before = run.state;
  run.step(20);
  EXPECT_NE(before.f64(Columns::reference)[0], run.state.f64(Columns::reference)[0]);
}

}  // namespace
}  // namespace truestep::molecular
