#include "server/persistence/sessions/session_archive.h"

#include <algorithm>

#include "engine/base/errors.h"
#include "engine/base/log.h"
#include "engine/base/text/short_number.h"
#include "server/persistence/files.h"
#include "server/sessions/session_id.h"

namespace truestep {

SessionArchive::SessionArchive(Place folder, ArchiveLimits limits, MemoryBudget& memory)
    : root_(std::move(folder)), limits_(limits), memory_(memory) {
  root_.make_folder();
  for (const std::string& id : root_.names()) {
    if (id.starts_with(".")) (root_ / id).remove_all();
    if (!is_session_id(id)) continue;
    try {
      const auto there = (root_ / id).status();
      if (!there || !S_ISDIR(there->st_mode))
        throw Error("session_damaged", "what is saved of session " + id + " is no folder");
      rows_[id].about = folder_of(id).about();
    } catch (const Error& e) {
      // It appears in no list, since its owner is unknown, but its id is taken.
      damage_.emplace_back(e.what());
      rows_[id].about = {id, "", "", 0, 0};
    }
  }
}

std::optional<SessionAbout> SessionArchive::find(std::string_view id) const {
  const std::lock_guard lock(mutex_);
  const auto it = rows_.find(id);
  return it == rows_.end() ? std::nullopt : std::optional(it->second.about);
}

std::vector<std::string> SessionArchive::list(std::string_view after, size_t limit,
                                              const net::Caller& caller) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> out;
  for (auto it = rows_.upper_bound(after); it != rows_.end() && out.size() < limit; ++it) {
    if (caller.may_see(it->second.about.owner)) out.push_back(it->first);
  }
  return out;
}

std::shared_ptr<SessionKeeper> SessionArchive::add(SessionFolder folder, const SessionAbout& about,
                                                   const Session& session,
                                                   SessionKeeper::Beginning beginning) {
  auto keeper = std::make_shared<SessionKeeper>(std::move(folder), session, std::move(beginning),
                                                KeepingMeans{files_, writer_, memory_});
  const std::lock_guard lock(mutex_);
  Row& row = rows_[about.id];
  row.about = about;
  row.keeper = keeper;
  row.loading = false;
  return keeper;
}

std::shared_ptr<SessionKeeper> SessionArchive::keep(const SessionAbout& about, const Session& session,
                                                    const boost::json::object& accuracy) {
  const SessionFolder folder =
      SessionFolder::create(root_, about, session.world().scene().canonical(), accuracy);
  try {
    auto keeper = add(folder, about, session, {});
    if (session.origin()) keeper->save_anew();
    return keeper;
  } catch (...) {
    // What is not kept is neither listed nor found by the next server.
    remove(about.id);
    folder.remove();
    throw;
  }
}

SavedSession SessionArchive::read(const std::string& id, std::optional<uint64_t> recorded) {
  {
    const std::lock_guard lock(mutex_);
    const auto it = rows_.find(id);
    if (it == rows_.end()) throw Error("unknown_session", "there is no session with this id");
    it->second.loading = true;
  }
  return read_saved_session(folder_of(id), recorded);
}

std::shared_ptr<SessionKeeper> SessionArchive::keep_on(const SavedSession& saved, const Session& session) {
  const SessionFolder folder = folder_of(saved.about.id);
  return add(folder, saved.about, session, {folder.contents().states, saved.next_number, saved.from_step});
}

void SessionArchive::unloaded(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const auto it = rows_.find(id);
  if (it == rows_.end()) return;
  it->second.keeper.reset();
  it->second.loading = false;
  it->second.used = std::chrono::steady_clock::now();
}

void SessionArchive::remove(const std::string& id) {
  {
    const std::lock_guard lock(mutex_);
    if (!rows_.contains(id)) return;
  }
  // First, because a session that cannot be removed stays.
  folder_of(id).remove();
  const std::lock_guard lock(mutex_);
  const auto it = rows_.find(id);
  if (it == rows_.end()) return;
  if (const auto keeper = it->second.keeper.lock()) keeper->abandon();
  rows_.erase(it);
}

void SessionArchive::require_room(double bytes) const {
  const std::lock_guard lock(mutex_);
  double sum = 0;
  for (const auto& [id, row] : rows_) sum += row.bytes;
  if (sum + bytes <= limits_.most_bytes) return;
  throw Error("quota_exceeded", "sessions on disk take " + short_number(sum / 1e6, 3) + " MB of the " +
                                    short_number(limits_.most_bytes / 1e6, 3) +
                                    " MB that this server keeps; delete some");
}

// Size of a folder and when it was last used: the age of its newest file counts if this server has not seen
// it used.
void SessionArchive::survey(const std::string& id) {
  const Place place = root_ / id;
  const double bytes = folder_bytes(place);
  using Clock = std::chrono::system_clock;
  const auto written = [](const Place& at) {
    const auto about = at.status();
    if (!about) return Clock::time_point();
    return Clock::from_time_t(about->st_mtim.tv_sec) +
           std::chrono::duration_cast<Clock::duration>(std::chrono::nanoseconds(about->st_mtim.tv_nsec));
  };
  auto newest = written(place);
  for (const std::string& name : place.names()) newest = std::max(newest, written(place / name));
  const auto age = std::max(Clock::now() - newest, Clock::duration(0));
  const std::lock_guard lock(mutex_);
  const auto it = rows_.find(id);
  if (it == rows_.end()) return;
  it->second.bytes = bytes;
  if (!it->second.surveyed && it->second.used == Time{})
    it->second.used = std::chrono::steady_clock::now() - std::chrono::duration_cast<Time::duration>(age);
  it->second.surveyed = true;
}

std::vector<std::string> SessionArchive::sweep() {
  std::vector<std::string> unknown;
  {
    const std::lock_guard lock(mutex_);
    for (auto& [id, row] : rows_) {
      const auto keeper = row.keeper.lock();
      if (!row.surveyed || (keeper && keeper->take_written())) unknown.push_back(id);
    }
  }
  for (const std::string& id : unknown) survey(id);
  std::vector<std::pair<Time, std::string>> unused;
  std::vector<std::string> gone;
  {
    const std::lock_guard lock(mutex_);
    const Time now = std::chrono::steady_clock::now();
    double sum = 0;
    for (const auto& [id, row] : rows_) {
      sum += row.bytes;
      if (row.surveyed && !row.loading && row.keeper.expired()) unused.emplace_back(row.used, id);
    }
    std::sort(unused.begin(), unused.end());
    for (const auto& [used, id] : unused) {
      if (now - used <= limits_.keep && sum <= limits_.most_bytes) break;
      sum -= rows_.at(id).bytes;
      rows_.erase(id);
      gone.push_back(id);
    }
  }
  for (const std::string& id : gone) {
    try {
      folder_of(id).remove();
    } catch (const Error& e) {
      log_warn("session {} comes back at the next start: {}", id, e.what());
    }
  }
  return gone;
}

}  // namespace truestep
