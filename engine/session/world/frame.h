// A frame: what some sink asked to see of one step. Immutable and shared; it holds only the requested fields.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/drawing.h"
#include "engine/core/observables.h"
#include "engine/core/state/state.h"

namespace truestep {

/// One field of one part, requested in a type (f64 fields may be requested as f32).
struct FieldKey {
  uint32_t part = 0;  ///< index in the world's parts
  uint32_t field = 0;
  Scalar type = Scalar::f32;
  friend auto operator<=>(const FieldKey&, const FieldKey&) = default;
};

/// What a sink wants in its frames.
struct FrameRequest {
  std::vector<FieldKey> fields;  ///< sorted, unique
  /// Optional contents that cost something; a set of bits.
  enum class Extras : uint8_t { none = 0, observables = 1, state_hash = 2 } extras = Extras::none;
  Wish wishes = Wish::none;  ///< of the drawing
  bool wants(Extras what) const { return (static_cast<uint8_t>(extras) & static_cast<uint8_t>(what)) != 0; }
};
constexpr FrameRequest::Extras operator|(FrameRequest::Extras a, FrameRequest::Extras b) {
  return static_cast<FrameRequest::Extras>(static_cast<uint8_t>(a) | static_cast<uint8_t>(b));
}

struct FrameBlock {
  FieldKey key;
  uint32_t width = 1;
  size_t rows = 0;
  std::vector<std::byte, CacheLineAllocator<std::byte>> data;  ///< rows x width, little-endian
};

struct Frame {
  uint64_t step = 0;
  double time = 0;                     ///< s
  double alpha = 0;                    ///< interpolation factor of the accumulator
  std::optional<uint64_t> state_hash;  ///< if requested
  uint32_t drawing_version = 1;
  std::vector<FrameBlock> blocks;           ///< in the order of the request
  Observables observables;                  ///< empty unless requested
  std::shared_ptr<const Drawing> constant;  ///< what changes only with the drawing's version; null unless
                                            ///< requested
  Drawing moving;                           ///< obstacles and marks, if requested

  size_t memory_bytes() const {
    size_t n = sizeof *this;
    for (const FrameBlock& b : blocks) n += b.data.size() + sizeof b;
    n += moving.obstacles.size() * sizeof(DrawnShape) + moving.contacts.size() * sizeof(ContactMark) +
         moving.joints.size() * sizeof(JointMark);
    return n;
  }
  const FrameBlock* find(const FieldKey& key) const {
    for (const FrameBlock& b : blocks) {
      if (b.key == key) return &b;
    }
    return nullptr;
  }
};

using FramePtr = std::shared_ptr<const Frame>;

struct JournalEntry;

/// Receives a session's frames. Called by the thread that advances the session, never concurrently.
class Sink {
 public:
  virtual ~Sink() = default;
  /// Whether this sink would take a frame of this step now; if no sink is due, no frame is built.
  virtual bool due(uint64_t step) = 0;
  virtual const FrameRequest& request() const = 0;
  virtual void accept(const FramePtr& frame) = 0;
  /// The session's past or clock changed: reset, seek, play, pause, instability.
  virtual void notify(std::string_view kind, uint64_t step, const std::string& detail) {}
  /// The session has ended; `code` is known to clients, the reason is a sentence.
  virtual void bye(std::string_view code, const std::string& reason) {}
  /// A command is about to be carried out.
  virtual void before_command(const JournalEntry& entry) {}
  /// The command was refused and changed nothing.
  virtual void command_refused(const JournalEntry& entry) {}
};

}  // namespace truestep
