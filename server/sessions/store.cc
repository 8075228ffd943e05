#include "server/sessions/store.h"

#include "engine/base/hash.h"
#include "engine/scene/json_write.h"
#include "engine/session/describe.h"
#include "engine/studies/accuracy.h"
#include "server/net/digest.h"

namespace truestep {

namespace json = boost::json;

std::string random_session_id() {
  std::string h = net::random_hex128();
  h[12] = '4';
  h[16] = "89ab"[(h[16] <= '9' ? h[16] - '0' : h[16] - 'a' + 10) & 3];
  return h.substr(0, 8) + '-' + h.substr(8, 4) + '-' + h.substr(12, 4) + '-' + h.substr(16, 4) + '-' +
         h.substr(20);
}

bool is_session_id(std::string_view text) {
  if (text.size() != 36) return false;
  for (size_t i = 0; i < text.size(); ++i) {
    const bool dash = i == 8 || i == 13 || i == 18 || i == 23;
    const char c = text[i];
    if (dash ? c != '-' : !((c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'))) return false;
  }
  return true;
}

namespace {
Error unknown_session() {
  return {"unknown_session", "there is no session with this id"};
}
}  // namespace

SessionStore::SessionStore(StoreLimits limits)
    : limits_(limits), arena_(std::make_shared<const ThreadArena>(limits.threads_per_session)) {}

void SessionStore::check_room(double bytes) const {
  if (entries_.size() >= limits_.max_sessions) {
    throw Error("quota_exceeded",
                "this server holds its most of " + std::to_string(limits_.max_sessions) + " sessions");
  }
  if (memory_ + bytes > limits_.max_memory_bytes) {
    throw Error("quota_exceeded", "the sessions of this server use all memory that it may use");
  }
}

SessionStore::Created SessionStore::create(const json::value& document, const std::string& id,
                                           const net::Caller& owner, Accuracy accuracy) {
  Hasher hasher;
  hasher.text(write_json(document));
  const uint64_t scene_hash = hasher.value();
  const auto existing = [&]() -> EntryPtr {
    const auto it = entries_.find(id);
    if (it == entries_.end()) return nullptr;
    if (!owner.may_see(it->second->owner)) throw unknown_session();
    if (it->second->scene_hash != scene_hash)
      throw Error("conflict", "a session with this id and another scene exists");
    return it->second;
  };
  {
    const std::lock_guard lock(mutex_);
    if (EntryPtr e = existing()) return {e, Created::How::existed};
    check_room(0);
  }
  Scene asked = require_scene(examine_scene(document, limits_.per_session));
  const Cost cost = estimate(asked);
  require_admission(cost, limits_.per_session);
  // A scene that asks for accuracy has a companion as large as itself.
  const double copies = asked.header.accuracy ? 2 : 1;
  const double bytes = copies * (cost.state_bytes + cost.workspace_bytes);
  SettledScene settled = accuracy == Accuracy::chosen
                             ? SettledScene{std::move(asked), {}}
                             : settle_accuracy(document, limits_.accuracy_seconds, *arena_);
  {
    const std::lock_guard lock(mutex_);
    check_room(bytes);
  }
  auto world = std::make_shared<const World>(std::move(settled.scene));
  require_admission(world->cost(world->initial_state()), limits_.per_session);
  auto entry = std::make_shared<SessionEntry>(id, std::move(world), arena_, bytes);
  entry->owner = owner.name;
  entry->scene_hash = scene_hash;
  entry->accuracy = std::move(settled.report);
  entry->estimated_step = cost.seconds_per_step;
  const std::lock_guard lock(mutex_);
  if (EntryPtr e = existing()) return {e, Created::How::existed};
  check_room(bytes);
  entries_.emplace(id, entry);
  memory_ += bytes;
  return {entry, Created::How::made};
}

EntryPtr SessionStore::find(std::string_view id, const net::Caller& caller) {
  const std::lock_guard lock(mutex_);
  const auto it = entries_.find(id);
  if (it != entries_.end()) {
    if (!caller.may_see(it->second->owner)) throw unknown_session();
    it->second->touch();
    return it->second;
  }
  const auto gone = expired_.find(id);
  if (gone != expired_.end() && caller.may_see(gone->second))
    throw Error("session_expired", "this session was removed because nobody used it");
  throw unknown_session();
}

EntryPtr SessionStore::remove(EntryPtr entry) {
  const std::lock_guard lock(mutex_);
  if (entries_.erase(entry->id)) memory_ -= entry->estimated_bytes;
  entry->removed = true;
  return entry;
}

std::vector<EntryPtr> SessionStore::list(std::string_view after, size_t limit,
                                         const net::Caller& caller) const {
  const std::lock_guard lock(mutex_);
  std::vector<EntryPtr> out;
  for (auto it = entries_.upper_bound(after); it != entries_.end() && out.size() < limit; ++it) {
    if (caller.may_see(it->second->owner)) out.push_back(it->second);
  }
  return out;
}

std::vector<EntryPtr> SessionStore::all() const {
  return list("", SIZE_MAX, {});
}

size_t SessionStore::size() const {
  const std::lock_guard lock(mutex_);
  return entries_.size();
}

std::vector<EntryPtr> SessionStore::expire() {
  std::vector<EntryPtr> out;
  const auto now = Clock::now();
  const std::lock_guard lock(mutex_);
  for (auto it = entries_.begin(); it != entries_.end();) {
    SessionEntry& e = *it->second;
    const Clock::time_point used{Clock::duration(e.last_used.load(std::memory_order_relaxed))};
    bool idle = now - used > limits_.idle_ttl && e.streams == 0;
    if (idle) {
      const std::unique_lock session_lock(e.mutex, std::try_to_lock);
      idle = session_lock.owns_lock() && !e.session.playing();
    }
    if (!idle) {
      ++it;
      continue;
    }
    e.removed = true;
    memory_ -= e.estimated_bytes;
    expired_[e.id] = e.owner;
    expired_order_.push_back(e.id);
    if (expired_order_.size() > 10000) {
      expired_.erase(expired_order_.front());
      expired_order_.pop_front();
    }
    out.push_back(it->second);
    it = entries_.erase(it);
  }
  return out;
}

}  // namespace truestep
