// Bundles: contents with a valid checksum are refused with a code or, if that is little work, replayed.
#include <cstddef>
#include <cstdint>

#include "engine/base/errors.h"
#include "engine/scene/admission.h"
#include "engine/session/snapshot/bundle.h"
#include "time_limit.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace truestep;
  static const auto arena = std::make_shared<const ThreadArena>(1);
  const auto contents = std::as_bytes(std::span(data, size));
  try {
    const Bundle bundle = read_bundle(seal(kBundleFile, contents));
    const Bundle again = read_bundle(write_bundle(bundle));
    if (again.journal.size() != bundle.journal.size() || again.end.hash != bundle.end.hash) __builtin_trap();
    const Cost cost = estimate(require_scene(read_scene(bundle.scene)));
    constexpr uint64_t kMostSteps = 50;
    if (cost.elements > 100 || cost.seconds_per_step > 1e-3 || bundle.end.step > kMostSteps) return 0;
    const TimeLimit limit;
    replay(bundle, arena);
  } catch (const Error& error) {
    if (error.code().empty() || error.code() == "internal") __builtin_trap();
  }
  return 0;
}
