// A session being created. Large scenes take seconds to build, and those that ask for accuracy are measured
// first. The creation has an id from the start; clients that query it are told its progress.
#pragma once
#include <atomic>
#include <exception>
#include <memory>
#include <string>

#include "engine/base/interrupt.h"
#include "engine/scene/admission.h"
#include "engine/scene/scene.h"
#include "server/sessions/entry.h"

namespace truestep {

/// A scene document that has been parsed but not built; parsing is fast whatever the scene describes.
struct SceneDraft {
  uint64_t hash = 0;            ///< of the document
  boost::json::value document;  ///< null unless the scene asks for accuracy, which reads it again
  SceneReport report;
  Cost cost;
  /// Whether the rest would take longer than a request should.
  bool heavy() const;
};

/// Takes as long as the document is large: not for threads that answer others.
SceneDraft read_draft(boost::json::value document);

struct Creation {
  /// `load` brings a session back from disk, `unload` is writing one there.
  enum class Kind : uint8_t { create, load, unload };
  Creation(std::string id, std::string owner, uint64_t scene_hash, Kind kind = Kind::create)
      : id(std::move(id)), owner(std::move(owner)), scene_hash(scene_hash), kind(kind) {}

  const std::string id, owner;
  const uint64_t scene_hash;
  const Kind kind;
  const Clock::time_point begun = Clock::now();
  std::atomic<const char*> stage{"reading"};
  Interrupt interrupt;
  Signal done;
  std::atomic<bool> ended{false};
  // Written before `ended`.
  EntryPtr entry;
  bool existed = false;
  std::exception_ptr error;
};

using CreationPtr = std::shared_ptr<Creation>;

}  // namespace truestep
