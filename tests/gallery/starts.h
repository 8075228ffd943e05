// The two starts of a scene (pass.cc) and what the first leaves for the second.
#pragma once
#include <cstdint>
#include <filesystem>

namespace truestep::gallery_pass {

/// What can be wrong with a scene.
enum Finding : unsigned {
  kExpect = 1,    ///< it does not measure what it says
  kGolden = 2,    ///< its hash is not the committed one
  kMemory = 4,    ///< it needs less or more than its estimate allows
  kThreads = 8,   ///< other bits with eight threads
  kResumed = 16,  ///< other bits from a saved state
  kPicture = 32,  ///< what it is about is outside its picture, or text lies on text
  kDied = 64      ///< it failed, or could not be read
};
inline constexpr const char* kNames[] = {"expect", "golden", "memory", "threads", "resumed", "picture"};

struct Wish {
  std::filesystem::path scene, golden, state;
  unsigned control = 0;  ///< the Finding that is to be provoked
};

/// Steps and the hashes after them.
struct Marks {
  uint64_t early_step = 0, early_hash = 0;
  uint64_t golden_step = 0, golden_hash = 0;
  uint64_t saved_step = 0, last_step = 0, last_hash = 0;
  unsigned found = 0;
};

/// Both return the findings, after a sentence about each.
unsigned first_start(const Wish& wish, Marks& marks);
unsigned second_start(const Wish& wish, const Marks& marks);

}  // namespace truestep::gallery_pass
