// What is there for queries to find in a session's present state: bodies by their exact solids, other systems
// by what is drawn of them. Made once for all queries of a request.
#pragma once
#include <deque>
#include <optional>
#include <string_view>
#include <vector>

#include "engine/collision/queries/queries.h"
#include "engine/session/session.h"

namespace truestep {

class Surroundings {
 public:
  /// Something that can be found: a placed solid, or (null) a point without extent.
  struct Item {
    const Solid* solid = nullptr;
    Pose pose;
    std::string_view system, part;  ///< ids; system empty, part its own id for a shape that no row carries
    std::optional<size_t> row;
    FloatBox box{};
  };

  /// For so many queries: several share a tree of boxes, one looks at all of them. Nothing is gathered before
  /// the first. The session must stay as it is meanwhile.
  Surroundings(const Session& session, size_t queries) : session_(session), indexed_(queries > 1) {}
  Surroundings(const Surroundings&) = delete;
  Surroundings& operator=(const Surroundings&) = delete;

  const Session& session() const { return session_; }
  /// visit(item) for every item whose box passes(const FloatBox&), in the order of systems and rows.
  template <class Passes, class Visit>
  void each(Passes&& passes, Visit&& visit) {
    gather();
    if (!indexed_) {
      for (const Item& item : items_) {
        if (passes(item.box)) visit(item);
      }
      return;
    }
    found_.clear();
    broad_.each(passes, [&](uint32_t i) {
      if (passes(items_[i].box)) found_.push_back(i);
    });
    std::sort(found_.begin(), found_.end());
    for (const uint32_t i : found_) visit(items_[i]);
  }

 private:
  void gather();
  void add_part(size_t part);
  void add_obstacles(size_t system);
  void add(Item item);

  const Session& session_;
  const bool indexed_;
  bool gathered_ = false;
  FramePtr frame_;
  std::deque<Solid> own_;      ///< keeps its addresses
  std::deque<Drawing> drawn_;  ///< keeps the ids of obstacles
  std::vector<Item> items_;
  std::vector<Box> boxes_;
  BroadPhase broad_;
  std::vector<uint32_t> found_;
};

}  // namespace truestep
