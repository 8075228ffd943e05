// Our side of nbody.py: reads bodies (n x 4 doubles: x, y, z, G m), evaluates their attraction once by the
// requested method, and prints the time. runner FILE SOFTENING direct | mixed | tree OPENING...; writes a (n
// x 3 doubles) to FILE.a after each.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

#include "engine/kernels/gravity/mixed_sums.h"
#include "engine/kernels/gravity/tree_walk.h"

using namespace truestep;
using namespace truestep::gravity;

namespace {

double cpu() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Median of several evaluations, after one that allocates memory.
template <class Evaluate>
double median_seconds(const Evaluate& evaluate, size_t n) {
  evaluate();
  std::vector<double> times;
  for (int k = 0; k < (n > 200000 ? 3 : 7); ++k) {
    const double start = cpu();
    evaluate();
    times.push_back(cpu() - start);
  }
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

}  // namespace

int main(int count, char** words) {
  if (count < 4) return 2;
  std::ifstream in(words[1], std::ios::binary | std::ios::ate);
  const auto n = static_cast<size_t>(in.tellg()) / (4 * sizeof(double));
  std::vector<double> rows(4 * n), x(3 * n), mu(n), a(3 * n);
  in.seekg(0).read(reinterpret_cast<char*>(rows.data()),
                   static_cast<std::streamsize>(rows.size() * sizeof(double)));
  for (size_t i = 0; i < n; ++i) {
    for (size_t k = 0; k < 3; ++k) x[3 * i + k] = rows[4 * i + k];
    mu[i] = rows[4 * i + 3];
  }
  const Softening softening{SofteningKind::plummer, std::atof(words[2])};
  const ThreadArena one(1);
  const auto report = [&](double opening, double seconds, const TreeWork& met) {
    const std::string name = words[1] + std::string(".") + std::to_string(opening) + ".a";
    std::ofstream(name, std::ios::binary)
        .write(reinterpret_cast<const char*>(a.data()),
               static_cast<std::streamsize>(a.size() * sizeof(double)));
    std::printf(
        "{\"opening\": %.9g, \"seconds\": %.9g, \"file\": \"%s\", \"bodies\": %.1f, \"nodes\": %.1f, "
        "\"far_nodes\": %.1f}\n",
        opening, seconds, name.c_str(), met.bodies, met.nodes, met.far_nodes);
  };
  if (words[3] == std::string("direct")) {
    DirectScratch scratch;
    const double seconds = median_seconds(
        [&] {
          direct_accelerations({x, mu}, softening, a, scratch, one);
        },
        n);
    report(0, seconds, {static_cast<double>(n), 0, 0});
    return 0;
  }
  if (words[3] == std::string("mixed")) {
    BodyTree tree;
    MixedScratch scratch;
    const double seconds = median_seconds(
        [&] {
          tree.build({x, mu}, one);
          mixed_accelerations(tree, softening, a, scratch, one);
        },
        n);
    report(0, seconds, {static_cast<double>(n), 0, 0});
    return 0;
  }
  for (int k = 4; k < count; ++k) {
    BodyTree tree;
    const TreeSettings settings{softening, std::atof(words[k])};
    std::vector<TreeWork> work;
    const auto evaluate = [&] {
      tree.build({x, mu}, one);
      work.resize(tree.groups().size());
      tree_sums(tree, settings, {a, {}, work}, one);
    };
    const double seconds = median_seconds(evaluate, n);
    TreeWork met;
    for (size_t g = 0; g < work.size(); ++g) {
      const auto share =
          static_cast<double>(tree.groups()[g].end - tree.groups()[g].begin) / static_cast<double>(n);
      met.bodies += share * work[g].bodies, met.nodes += share * work[g].nodes,
          met.far_nodes += share * work[g].far_nodes;
    }
    report(settings.opening, seconds, met);
  }
  return 0;
}
