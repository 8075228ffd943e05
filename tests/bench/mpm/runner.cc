// Our side of mpm.py: a cube of fluid falls, as in the peer's scene (uniform particles from a file of n x 3
// floats), or a cube of another material. runner FILE DIMENSION CELLS PARTICLES_ALONG LAW SUBSTEPS STEPS
// THREADS [profile] prints CPU and wall seconds of STEPS steps of SUBSTEPS substeps each and the properties
// of the fall.
#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

#include "engine/systems/mpm/mpm.h"

using namespace truestep;

namespace {

double seconds(clockid_t clock) {
  timespec t;
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// The law of that name with waves as fast as in the peer's fluid, 20 m/s at 1 kg/m^3.
mpm::BodyDef body(const std::string& law, double half) {
  mpm::BodyDef b;
  b.center = {0.35, 0.35, 0.35}, b.half_extents = {half, half, half};
  b.density = 1, b.bulk_modulus = 400, b.youngs_modulus = 300, b.poisson_ratio = 0.3;
  const char* names[] = {"fluid", "corotated", "neo_hookean", "snow", "sand", "foam"};
  for (int k = 0; k < 6; ++k) {
    if (law == names[k]) b.material = static_cast<mpm::Law>(k);
  }
  return b;
}

}  // namespace

int main(int count, char** words) {
  if (count < 9) return 2;
  mpm::MpmDef d;
  d.dimension = std::atoi(words[2]);
  d.cell = 1.0 / std::atoi(words[3]);
  d.particles_per_axis = d.dimension == 2 ? 3 : 2;
  // Waves cross 0.512 cells per substep of the peer; slightly compressed, those of the fluid are faster.
  d.courant = 0.52;
  d.bodies = {body(words[5], 0.5 * std::atoi(words[4]) * d.cell / d.particles_per_axis)};
  const int substeps = std::atoi(words[6]), steps = std::atoi(words[7]);
  const double h = 2e-4 * 128 * d.cell, dt = h * substeps;
  const mpm::Mpm system(d, {.id = "mpm", .gravity = {0, -9.8, 0}, .dt = dt});
  State s = system.initial_state();
  const auto x = s.span<float>(mpm::columns::position);
  const size_t n = x.size() / 3;
  if (std::ifstream in(words[1], std::ios::binary); in) {
    // The peer's positions.
    in.read(reinterpret_cast<char*>(x.data()), static_cast<std::streamsize>(x.size() * sizeof(float)));
  }
  Workspace workspace;
  const ThreadArena arena(std::atoi(words[8]));
  Profile profile;
  const auto run = [&](int from, int to) {
    for (int k = from; k < to; ++k) {
      system.step(s, {.t = k * dt,
                      .h = dt,
                      .step = static_cast<uint64_t>(k),
                      .workspace = workspace,
                      .arena = arena,
                      .profile = &profile});
    }
  };
  const auto fall = [&] {
    double sum = 0;
    const auto v = s.span<float>(mpm::columns::velocity);
    for (size_t i = 0; i < n; ++i) sum += double{v[3 * i + 1]};
    return sum / static_cast<double>(n);
  };
  const auto calls = [&] {
    for (const auto& row : profile.rows()) {
      if (row.name == "mpm gather") return row.calls;
    }
    return uint64_t{0};
  };
  const int warm = std::max(1, 20 / substeps);
  run(0, warm);
  const uint64_t earlier = calls();
  const double before = fall(), cpu = seconds(CLOCK_PROCESS_CPUTIME_ID), wall = seconds(CLOCK_MONOTONIC);
  run(warm, warm + steps);
  const double used = seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu, took = seconds(CLOCK_MONOTONIC) - wall;
  rusage memory{};
  getrusage(RUSAGE_SELF, &memory);
  for (const auto& row : profile.rows()) {
    if (count > 9)
      std::fprintf(stderr, "%-14s %.3f s, %llu calls\n", row.name.c_str(), row.seconds,
                   static_cast<unsigned long long>(row.calls));
  }
  std::printf(
      "{\"particles\": %zu, \"cpu\": %.9g, \"wall\": %.9g, \"substeps\": %d, \"fall_error\": %.3g, "
      "\"megabytes\": %.4g, \"hash\": \"%016lx\"}\n",
      n, used, took, static_cast<int>(calls() - earlier), fall() - before + 9.8 * dt * steps,
      static_cast<double>(memory.ru_maxrss) / 1024, static_cast<unsigned long>(s.hash()));
}
