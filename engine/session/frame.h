// A frame: what some sink asked to see of one step. Immutable and shared; it holds the requested fields only.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/observables.h"
#include "engine/core/state.h"

namespace truestep {

/// One field of one system, wanted in a type (f64 fields may be asked for as f32).
struct FieldKey {
  uint32_t system = 0;
  uint32_t field = 0;
  Scalar type = Scalar::f32;
  friend auto operator<=>(const FieldKey&, const FieldKey&) = default;
};

/// What a sink wants in its frames.
struct FrameRequest {
  std::vector<FieldKey> fields;  ///< sorted, unique
  enum class Extras : uint8_t { none, observables } extras = Extras::none;
};

struct FrameBlock {
  FieldKey key;
  uint32_t width = 1;
  size_t rows = 0;
  std::vector<std::byte, CacheLineAllocator<std::byte>> data;  ///< rows x width, little-endian
};

struct Frame {
  uint64_t step = 0;
  double time = 0;   ///< s
  double alpha = 0;  ///< interpolation factor of the accumulator
  uint64_t state_hash = 0;
  uint32_t topology_version = 1;
  std::vector<FrameBlock> blocks;  ///< in the order of the request
  Observables observables;         ///< empty unless asked for

  const FrameBlock* find(const FieldKey& key) const {
    for (const FrameBlock& b : blocks) {
      if (b.key == key) return &b;
    }
    return nullptr;
  }
};

using FramePtr = std::shared_ptr<const Frame>;

struct JournalEntry;

/// Takes frames of a session. Called by the thread that advances the session, never by two at once.
class Sink {
 public:
  virtual ~Sink() = default;
  /// Whether this sink would take a frame of this step now; a frame that no sink is due for is not built.
  virtual bool due(uint64_t step) = 0;
  virtual const FrameRequest& request() const = 0;
  virtual void accept(const FramePtr& frame) = 0;
  /// The session's past or clock changed: reset, seek, play, pause, instability.
  virtual void notify(std::string_view kind, uint64_t step, const std::string& detail) {}
  /// A command is about to be carried out.
  virtual void before_command(const JournalEntry& entry) {}
  /// It made no sense and changed nothing.
  virtual void command_refused(const JournalEntry& entry) {}
};

}  // namespace truestep
