#include "server/sessions/store.h"

#include <algorithm>
#include <ctime>

#include "engine/base/log.h"
#include "engine/session/describe.h"
#include "engine/sinks/picture/draw/trails.h"
#include "engine/studies/precision/accuracy.h"
#include "server/persistence/sessions/session_archive.h"

namespace truestep {

namespace json = boost::json;

namespace {
Error unknown_session() {
  return {"unknown_session", "there is no session with this id"};
}
}  // namespace

SessionStore::SessionStore(StoreLimits limits, MemoryBudget& budget, SessionArchive* archive)
    : limits_(limits),
      budget_(budget),
      archive_(archive),
      arena_(std::make_shared<const ThreadArena>(limits.threads_per_session)) {}

void SessionStore::check_room() const {
  if (entries_.size() + creations_.size() < limits_.max_sessions) return;
  throw Error("quota_exceeded",
              "this server has reached its limit of " + std::to_string(limits_.max_sessions) + " sessions");
}

SessionStore::Begun SessionStore::begin(const std::string& id, uint64_t scene_hash,
                                        const net::Caller& owner) {
  const auto check = [&](const std::string& existing_owner, uint64_t existing_hash) {
    if (!owner.may_see(existing_owner)) throw unknown_session();
    if (existing_hash != scene_hash)
      throw Error("conflict", "a session with this id and another scene exists");
  };
  const std::lock_guard lock(mutex_);
  if (const auto it = entries_.find(id); it != entries_.end()) {
    check(it->second->owner, it->second->scene_hash);
    auto there = std::make_shared<Creation>(id, owner.name, scene_hash);
    there->entry = it->second;
    there->existed = true;
    there->ended = true;
    return {there, Begun::How::before};
  }
  if (const auto it = creations_.find(id); it != creations_.end() && !it->second->ended) {
    check(it->second->owner, it->second->scene_hash);
    return {it->second, Begun::How::before};
  }
  if (archive_) {
    if (const auto about = archive_->find(id)) {
      check(about->owner, about->scene_hash);
      return begin_loading(id, about->owner, about->scene_hash);
    }
  }
  // Failures are remembered for clients that were told to ask again; the oldest are forgotten first.
  constexpr size_t kMostRemembered = 256;
  constexpr auto kRemembered = std::chrono::minutes(10);
  std::erase_if(creations_, [&](const auto& c) {
    return c.second->ended && (c.second->entry || creations_.size() > kMostRemembered ||
                               Clock::now() - c.second->begun > kRemembered);
  });
  check_room();
  const auto creation = std::make_shared<Creation>(id, owner.name, scene_hash);
  creations_[id] = creation;
  return {creation, Begun::How::anew};
}

SessionStore::Begun SessionStore::begin_loading(const std::string& id, const std::string& owner,
                                                uint64_t scene_hash) {
  check_room();
  const auto creation = std::make_shared<Creation>(id, owner, scene_hash, Creation::Kind::load);
  creation->stage = "restoring";
  creation->existed = true;
  creations_[id] = creation;
  return {creation, Begun::How::stored};
}

SessionStore::Begun SessionStore::load(std::string_view id, const net::Caller& caller) {
  const std::lock_guard lock(mutex_);
  if (const auto it = entries_.find(id); it != entries_.end() && caller.may_see(it->second->owner)) {
    auto there = std::make_shared<Creation>(it->first, it->second->owner, it->second->scene_hash);
    there->ended = true;
    return {there, Begun::How::before};
  }
  const auto it = creations_.find(id);
  if (it != creations_.end() && !it->second->ended && caller.may_see(it->second->owner))
    return {it->second, Begun::How::before};
  const auto about = archive_ ? archive_->find(id) : std::nullopt;
  if (!about || !caller.may_see(about->owner)) throw unknown_session();
  return begin_loading(about->id, about->owner, about->scene_hash);
}

void SessionStore::keep(SessionEntry& entry) {
  if (!archive_) return;
  const SceneHeader& header = entry.session.world().scene().header;
  const SessionAbout about{entry.id, entry.owner, header.title.empty() ? header.name : header.title,
                           entry.scene_hash, static_cast<int64_t>(std::time(nullptr))};
  entry.keeper = archive_->keep(about, entry.session, entry.accuracy);
  entry.keeper->keep_for(entry.recording);
  entry.session.add_sink(entry.keeper);
}

EntryPtr SessionStore::build(Creation& creation, SceneDraft draft, Accuracy accuracy,
                             const std::function<void(SessionEntry&)>& prepare) {
  const InterruptScope scope(creation.interrupt);
  interruption_point();
  Scene asked = require_scene(examine_further(std::move(draft.report), limits_.per_session));
  require_admission(draft.cost, limits_.per_session);
  // A scene that asks for accuracy is measured with a second copy of itself.
  const double copies = asked.header.accuracy ? 2 : 1;
  // The state counts twice: slow steps are computed in a copy.
  const auto bytes = [&](const Cost& c) { return copies * (2 * c.state_bytes + c.workspace_bytes); };
  auto lease = budget_.lease(bytes(draft.cost), "this scene");
  const auto admit = [&](const Cost& c) {
    require_admission(c, limits_.per_session);
    lease.require(std::max(lease.bytes(), bytes(c)), "measuring this scene");
  };
  creation.stage = "measuring";
  SettledScene settled = accuracy == Accuracy::chosen || !asked.header.accuracy
                             ? SettledScene{std::move(asked), {}}
                             : settle_accuracy(draft.document, limits_.accuracy_seconds, *arena_, admit);
  creation.stage = "building";
  auto world = std::make_shared<const World>(std::move(settled.scene));
  require_admission(world->cost(world->initial_state()), limits_.per_session);
  if (world->scene().header.accuracy) lease.require(bytes(estimate(world->scene())), "this scene");
  lease.require(lease.bytes() + Session::most_series_bytes(*world), "this scene");
  interruption_point();
  auto entry =
      std::make_shared<SessionEntry>(creation.id, std::move(world), arena_, budget_, std::move(lease));
  entry->owner = creation.owner;
  entry->scene_hash = creation.scene_hash;
  entry->accuracy = std::move(settled.report);
  entry->estimated_step = draft.cost.seconds_per_step;
  entry->trails = TrailSink::of(entry->session.world());
  if (entry->trails) entry->session.add_sink(entry->trails);
  prepare(*entry);
  return entry;
}

void SessionStore::make(const CreationPtr& creation, SceneDraft draft, Accuracy accuracy,
                        const std::function<void(SessionEntry&)>& prepare) {
  try {
    creation->entry = build(*creation, std::move(draft), accuracy, prepare);
  } catch (...) {
    creation->error = std::current_exception();
  }
  {
    const std::lock_guard lock(mutex_);
    if (creation->entry) entries_.emplace(creation->id, creation->entry);
    // A failed load is tried again by the next client that asks.
    if (creation->entry || creation->kind == Creation::Kind::load) creations_.erase(creation->id);
    creation->ended = true;
  }
  if (archive_ && !creation->entry && creation->kind == Creation::Kind::load)
    archive_->unloaded(creation->id);
  creation->done.notify();
}

void SessionStore::fail(const CreationPtr& creation, std::exception_ptr error) {
  creation->error = std::move(error);
  {
    const std::lock_guard lock(mutex_);
    if (creation->kind == Creation::Kind::load) creations_.erase(creation->id);
    creation->ended = true;
  }
  if (archive_ && creation->kind == Creation::Kind::load) archive_->unloaded(creation->id);
  creation->done.notify();
}

EntryPtr SessionStore::create(const json::value& document, const std::string& id, const net::Caller& owner,
                              Accuracy accuracy, const std::function<void(SessionEntry&)>& prepare) {
  SceneDraft draft = read_draft(document);
  const Begun begun = begin(id, draft.hash, owner);
  if (begun.how == Begun::How::anew) make(begun.creation, std::move(draft), accuracy, prepare);
  if (begun.creation->error) {
    forget(begun.creation);
    std::rethrow_exception(begun.creation->error);
  }
  return begun.creation->entry;
}

CreationPtr SessionStore::creation(std::string_view id, const net::Caller& caller) const {
  const std::lock_guard lock(mutex_);
  const auto it = creations_.find(id);
  return it != creations_.end() && caller.may_see(it->second->owner) ? it->second : nullptr;
}

void SessionStore::forget(const CreationPtr& creation) {
  creation->interrupt.raise();
  const std::lock_guard lock(mutex_);
  const auto it = creations_.find(creation->id);
  if (it != creations_.end() && it->second == creation && creation->ended) creations_.erase(it);
}

void SessionStore::cancel_creations() {
  const std::lock_guard lock(mutex_);
  for (const auto& [id, creation] : creations_) creation->interrupt.raise();
}

EntryPtr SessionStore::find(std::string_view id, const net::Caller& caller) {
  const std::lock_guard lock(mutex_);
  const auto it = entries_.find(id);
  if (it != entries_.end()) {
    if (!caller.may_see(it->second->owner)) throw unknown_session();
    it->second->touch();
    return it->second;
  }
  const auto making = creations_.find(id);
  if (making != creations_.end() && !making->second->ended && caller.may_see(making->second->owner)) {
    if (making->second->kind != Creation::Kind::create) return nullptr;
    throw Error("creating", "this session is still being made");
  }
  if (archive_) {
    const auto about = archive_->find(id);
    if (about && caller.may_see(about->owner)) return nullptr;
  }
  const auto gone = expired_.find(id);
  if (gone != expired_.end() && caller.may_see(gone->second))
    throw Error("session_expired", "this session was removed because it was unused");
  throw unknown_session();
}

EntryPtr SessionStore::remove(EntryPtr entry) {
  const std::lock_guard lock(mutex_);
  entries_.erase(entry->id);
  entry->removed = true;
  return entry;
}

std::vector<std::string> SessionStore::list(std::string_view after, size_t limit,
                                            const net::Caller& caller) const {
  std::vector<std::string> out, stored;
  if (archive_) stored = archive_->list(after, limit, caller);
  {
    const std::lock_guard lock(mutex_);
    for (auto it = entries_.upper_bound(after); it != entries_.end() && out.size() < limit; ++it) {
      if (caller.may_see(it->second->owner)) out.push_back(it->first);
    }
  }
  const auto loaded = static_cast<std::ptrdiff_t>(out.size());
  out.insert(out.end(), stored.begin(), stored.end());
  std::inplace_merge(out.begin(), out.begin() + loaded, out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  if (out.size() > limit) out.resize(limit);
  return out;
}

std::vector<EntryPtr> SessionStore::all() const {
  const std::lock_guard lock(mutex_);
  std::vector<EntryPtr> out;
  for (const auto& [id, entry] : entries_) out.push_back(entry);
  return out;
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
      idle = session_lock.owns_lock() && !e.session.playing() && !e.jobs.scheduled;
    }
    if (!idle) {
      ++it;
      continue;
    }
    e.removed = true;
    auto unloading = std::make_shared<Creation>(e.id, e.owner, e.scene_hash, Creation::Kind::unload);
    unloading->stage = "unloading";
    creations_[e.id] = std::move(unloading);
    out.push_back(it->second);
    it = entries_.erase(it);
  }
  return out;
}

void SessionStore::unloaded(const EntryPtr& entry) {
  if (archive_) archive_->unloaded(entry->id);
  CreationPtr unloading;
  {
    const std::lock_guard lock(mutex_);
    const auto it = creations_.find(entry->id);
    if (it != creations_.end()) {
      unloading = it->second;
      creations_.erase(it);
      unloading->ended = true;
    }
    if (!entry->keeper) {
      expired_[entry->id] = entry->owner;
      expired_order_.push_back(entry->id);
      if (expired_order_.size() > 10000) {
        expired_.erase(expired_order_.front());
        expired_order_.pop_front();
      }
    }
  }
  if (unloading) unloading->done.notify();
}

}  // namespace truestep
