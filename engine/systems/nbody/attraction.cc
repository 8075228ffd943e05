#include "engine/systems/nbody/attraction.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/base/text/short_number.h"
#include "engine/kernels/gravity/mixed_sums.h"

namespace truestep::nbody {

namespace {

/// G m of every body.
std::span<const double> strengths(const State& s, Workspace& workspace) {
  const auto mass = s.f64(Columns::mass);
  const auto mu = workspace.doubles("nbody.mu", mass.size()).first(mass.size());
  const double g = parameter(s, Parameter::gravitational_constant);
  for (size_t i = 0; i < mass.size(); ++i) mu[i] = g * mass[i];
  return mu;
}

/// The tree's errors do not cancel between the two bodies of a pair as forces do: their sum is removed
/// evenly, so that the centre of mass moves in a straight line.
void remove_net_force(const gravity::Bodies& bodies, std::span<double> a, const ThreadArena& arena) {
  const size_t n = bodies.size();
  const auto total = [&](size_t component) {
    const auto block = [&](size_t begin, size_t end) {
      double sum = 0;
      for (size_t i = begin; i < end; ++i) sum += bodies.mu[i] * (component < 3 ? a[3 * i + component] : 1.0);
      return sum;
    };
    return arena.sum_blocks(n, kBlockRows, block);
  };
  const double mu = total(3);
  if (!(mu > 0)) return;
  const Vec3 mean{total(0) / mu, total(1) / mu, total(2) / mu};
  arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) store3(a.data(), i, load3(a.data(), i) - mean);
  });
}

}  // namespace

gravity::TreeSettings Attraction::settings(const State& s) const {
  // Measured on Plummer spheres of 1e4 to 1e6 bodies: the error grows as the opening angle to the power 0.65
  // to 0.7.
  constexpr double kOpening = 100;
  return {{def_.softening_kind, parameter(s, Parameter::softening)},
          kOpening * def_.force_error * std::sqrt(def_.force_error)};
}

void Attraction::tree_sums(const gravity::Bodies& bodies, const State& s, const gravity::TreeSums& out,
                           Workspace& workspace, const ThreadArena& arena) const {
  auto& tree = workspace.object<gravity::BodyTree>("nbody.tree");
  tree.build(bodies, arena);
  const Method method = chosen_method(def_, bodies.size());
  if (method == Method::mixed)
    return mixed_accelerations(tree, settings(s).softening, out.a,
                               workspace.object<gravity::MixedScratch>("nbody.mixed"), arena);
  if (method == Method::tree) return gravity::tree_sums(tree, settings(s), out, arena);
  multipole_sums(tree, settings(s), out, workspace.object<gravity::MultipoleScratch>("nbody.multipoles"),
                 arena);
}

void Attraction::accelerations(const State& s, std::span<const double> x, std::span<double> a,
                               Workspace& workspace, const ThreadArena& arena) const {
  const gravity::Bodies bodies{x, strengths(s, workspace)};
  if (chosen_method(def_, bodies.size()) == Method::direct) {
    auto& scratch = workspace.object<gravity::DirectScratch>("nbody.direct");
    return direct_accelerations(bodies, settings(s).softening, a, scratch, arena);
  }
  tree_sums(bodies, s, {a}, workspace, arena);
  remove_net_force(bodies, a, arena);
}

double Attraction::potential(const State& s, std::span<const double> x, Workspace& workspace,
                             const ThreadArena& arena) const {
  const gravity::Bodies bodies{x, strengths(s, workspace)};
  const double g = parameter(s, Parameter::gravitational_constant);
  if (g == 0) return 0;
  const size_t n = bodies.size();
  const Method method = chosen_method(def_, n);
  if (method == Method::direct || method == Method::mixed) {
    auto& scratch = workspace.object<gravity::DirectScratch>("nbody.direct");
    return -direct_potential(bodies, settings(s).softening, scratch, arena) / g;
  }
  const auto a = workspace.doubles("nbody.unused", 3 * n).first(3 * n),
             p = workspace.doubles("nbody.p", n).first(n);
  tree_sums(bodies, s, {a, p}, workspace, arena);
  return -0.5 / g * arena.sum_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = begin; i < end; ++i) sum += bodies.mu[i] * p[i];
    return sum;
  });
}

std::string Attraction::reason(size_t n) const {
  const std::string bodies = std::to_string(n) + " bodies";
  const Method method = chosen_method(def_, n);
  if (method == Method::mixed) return bodies + ", all pairs, most in single precision";
  if (method != Method::direct) {
    return bodies + (method == Method::tree ? " by a tree" : " by the fast multipole method") + ", error " +
           short_number(def_.force_error) + " of an acceleration";
  }
  return bodies + ", every pair" + (def_.method == Method::direct ? "" : ": no tree is faster");
}

std::vector<Vec3> attraction_at_start(const std::vector<Body>& bodies, const NbodyDef& def) {
  static const ThreadArena kSerial(1);
  const State s = nbody_state(bodies, def.gravitational_constant, def.softening);
  Workspace workspace;
  std::vector<double> a(3 * bodies.size());
  Attraction(def).accelerations(s, s.f64(Columns::position), a, workspace, kSerial);
  std::vector<Vec3> out;
  for (size_t i = 0; i < bodies.size(); ++i) out.push_back(load3(a.data(), i));
  return out;
}

}  // namespace truestep::nbody
