#include "tests/gallery/starts.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <iostream>
#include <limits>
#include <sstream>

#include "engine/base/errors.h"
#include "engine/scene/admission.h"
#include "engine/scene/json/json.h"
#include "engine/session/expectation.h"
#include "engine/session/session.h"
#include "engine/studies/precision/accuracy.h"
#include "tests/gallery/pictured.h"
#include "tests/gallery/weighed_memory.h"
#include "tests/support/slowdown.h"

namespace truestep::gallery_pass {
namespace {

constexpr uint64_t kGoldenStep = 40;  // steps to a committed hash
constexpr uint64_t kFewSteps = 20;    // from the saved state
constexpr int kThreadsBeside = 8;     // of the second start

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

Scene scene_of(const Wish& wish) {
  constexpr double kAccuracySeconds = 2;  // CPU time for choosing a method
  return settle_accuracy(parse_json(text_of(wish.scene)), kAccuracySeconds, ThreadArena(1)).scene;
}

std::shared_ptr<const ThreadArena> arena(int threads) {
  return std::make_shared<const ThreadArena>(threads);
}

void save(const Session& session, const std::filesystem::path& file) {
  const auto bytes = session.state().serialize();
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

WorldState saved(const std::filesystem::path& file) {
  const std::string text = text_of(file);
  std::vector<std::byte> bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return WorldState::deserialize(bytes);
}

// The steps at which hashes are taken, from how many the scene has: the second start repeats a tenth and goes
// on from two fifths of the run.
void choose_steps(uint64_t steps, Marks& marks) {
  marks.golden_step = std::min(kGoldenStep, steps);
  marks.early_step = std::min(marks.golden_step, std::max<uint64_t>(10, steps / 10));
  marks.saved_step = 2 * steps / 5;
  marks.last_step = std::min(marks.saved_step + kFewSteps, steps);
}

unsigned judge(const Verdict& v) {
  std::cout << (v.met ? "ok      " : "MISSED  ") << v.expected.quantity << " = ";
  if (v.measured)
    std::cout << *v.measured;
  else
    std::cout << "(no such quantity)";
  if (v.expected.min) std::cout << ", at least " << *v.expected.min;
  if (v.expected.max) std::cout << ", at most " << *v.expected.max;
  if (v.expected.equals) std::cout << ", expected " << *v.expected.equals << " +- " << v.expected.tolerance;
  std::cout << '\n';
  return v.met ? 0U : unsigned{kExpect};
}

unsigned judge_golden(const Wish& wish, uint64_t hash) {
  std::ifstream lines(wish.golden);
  std::string name;
  uint64_t golden = 0;
  while (lines >> name >> std::hex >> golden) {
    if (name != wish.scene.stem().string()) continue;
    if (wish.control == kGolden) golden ^= 1;
    if (golden == hash) return 0;
    std::cout << "the committed hash is " << std::hex << golden << std::dec
              << ", see tests/gallery/golden_hashes.txt\n";
    return kGolden;
  }
  return 0;
}

unsigned judge_memory(const Wish& wish, double estimated, const testing::WeighedMemory& memory,
                      size_t systems) {
  if (kSlowdown > 1) return 0;  // the sanitizers' own memory is not estimated
  if (wish.control == kMemory) estimated *= 3;
  std::cout << "memory " << memory.bytes() << " B, estimated " << estimated << " B\n";
  if (!testing::memory_is_off(estimated, memory.bytes(), static_cast<double>(systems))) return 0;
  std::cout << "the estimate of memory is beyond " << testing::kLeastRatio << " to " << testing::kMostRatio
            << " of it\n";
  return kMemory;
}

unsigned judge_hash(uint64_t step, uint64_t hash, uint64_t wanted, Finding finding) {
  std::cout << "step " << step << ' ' << std::hex << hash << std::dec << '\n';
  if (hash == wanted) return 0;
  std::cout << (finding == kThreads ? "with other threads" : "from the saved state")
            << " it differs: with one thread, in one run " << std::hex << wanted << std::dec << '\n';
  return finding;
}

}  // namespace

unsigned first_start(const Wish& wish, Marks& marks) {
  testing::return_large_blocks();
  Scene scene = scene_of(wish);
  if (wish.control == kExpect && !scene.header.expect.empty())
    scene.header.expect.front().min = std::numeric_limits<double>::infinity();
  Expectations expectations(scene);
  const Cost cost = estimate(scene);
  const size_t systems = scene.systems.size();
  const auto steps = static_cast<uint64_t>(std::llround(scene.header.time.duration / scene.header.time.dt));
  choose_steps(steps, marks);
  const auto one = arena(1);
  testing::WeighedMemory memory(cost.state_bytes + cost.workspace_bytes);
  Session session(std::make_shared<const World>(std::move(scene)), one, {.history_bytes = 0});
  if (!expectations.empty()) expectations.add(session.observe(), session.time());
  if (marks.saved_step == 0) save(session, wish.state);
  for (uint64_t n = 1; n <= steps && session.step(1) == 1; ++n) {
    memory.after_step(n);
    if (expectations.needs_every_step() || n == steps) expectations.add(session.observe(), session.time());
    if (n == marks.golden_step) marks.golden_hash = session.hash();
    if (n == marks.early_step) marks.early_hash = session.hash();
    if (n == marks.saved_step) save(session, wish.state);
    if (n == marks.last_step) marks.last_hash = session.hash();
  }
  session.examine();
  if (session.failure()) return std::cout << session.failure()->detail << '\n', kDied;
  if (steps < memory.kSteps) memory.look();
  unsigned found = judge_memory(wish, memory.estimated(), memory, systems);
  for (const Verdict& v : expectations.verdicts()) found |= judge(v);
  std::cout << "step " << marks.golden_step << ' ' << std::hex << marks.golden_hash << std::dec << '\n';
  return found | judge_golden(wish, marks.golden_hash);
}

unsigned second_start(const Wish& wish, const Marks& marks) {
  const auto world = std::make_shared<const World>(scene_of(wish));
  const auto eight = arena(kThreadsBeside);
  const uint64_t early = marks.early_hash ^ (wish.control == kThreads ? 1 : 0);
  const uint64_t last = marks.last_hash ^ (wish.control == kResumed ? 1 : 0);
  unsigned found = 0;
  {
    Session again(world, eight, {.history_bytes = 0});
    again.step(marks.early_step);
    found |= judge_hash(marks.early_step, again.hash(), early, kThreads);
  }
  Session resumed(world, eight, {.history_bytes = 0});
  resumed.restore(saved(wish.state));
  if (!is_pictured(resumed, wish.control == kPicture ? Spoil::camera : Spoil::nothing)) found |= kPicture;
  resumed.step(marks.last_step - marks.saved_step);
  return found | judge_hash(marks.last_step, resumed.hash(), last, kResumed);
}

}  // namespace truestep::gallery_pass
