#include "server/persistence/recording_catalogue.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <ctime>

#include "engine/base/errors.h"
#include "engine/base/log.h"
#include "engine/base/text/short_number.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "engine/sinks/recording/log/chunk_log.h"
#include "engine/sinks/recording/log/recover.h"
#include "engine/sinks/recording/recording_reader.h"
#include "server/persistence/files.h"
#include "server/sessions/session_id.h"

namespace truestep {

namespace json = boost::json;

namespace {

constexpr std::string_view kEnding = ".vtkhdf", kNote = ".json";
constexpr const char* kNames[] = {"live", "finished", "closed", "repaired", "incomplete", "damaged"};
constexpr size_t kMostNote = 64 << 10;
constexpr size_t kIdLength = 36;

Place note_place(const Place& recording) {
  return recording.with_ending(kNote);
}

// ID for the first, ID.2, ID.3 ... for the next.
std::string name_of(const std::string& session, uint64_t number) {
  return number == 1 ? session : session + "." + std::to_string(number);
}

uint64_t number_of(std::string_view id) {
  uint64_t n = 1;
  if (id.size() > kIdLength + 1) std::from_chars(id.data() + kIdLength + 1, id.data() + id.size(), n);
  return n;
}

std::string text_member(const json::object& o, const char* name) {
  const json::value* v = o.if_contains(name);
  return v && v->is_string() ? std::string(v->as_string()) : std::string();
}

// What the note says; a recording without a note comes from a server that wrote none.
RecordingFacts read_note(const Place& recording, const std::string& id) {
  RecordingFacts f;
  f.id = id;
  f.session = id.substr(0, kIdLength);
  try {
    const json::value v = parse_json(text_of(read_file(note_place(recording), kMostNote)));
    const json::object& o = v.as_object();
    f.owner = text_member(o, "owner");
    f.title = text_member(o, "title");
    f.note = text_member(o, "note");
    if (const json::value* asked = o.if_contains("asked")) f.asked = asked->as_object();
    f.created = o.at("created").to_number<int64_t>();
    f.frames = o.at("frames").to_number<uint64_t>();
    const std::string state = text_member(o, "state");
    for (size_t k = 0; k < std::size(kNames); ++k) {
      if (state == kNames[k]) f.state = static_cast<RecordingFate>(k);
    }
  } catch (const std::exception&) {
    f.state = RecordingFate::live;
    if (const auto about = recording.status()) f.created = about->st_mtime;
  }
  return f;
}

std::string note_text(const RecordingFacts& f) {
  json::object o{{"owner", f.owner},     {"title", f.title},
                 {"created", f.created}, {"state", state_name(f.state)},
                 {"frames", f.frames},   {"note", f.note}};
  if (!f.asked.empty()) o["asked"] = f.asked;
  return write_json(o);
}

Error unknown() {
  return {"not_found", "there is no recording with this id"};
}

}  // namespace

const char* state_name(RecordingFate state) {
  return kNames[static_cast<size_t>(state)];
}

bool is_recording_id(std::string_view text) {
  if (!is_session_id(text.substr(0, kIdLength))) return false;
  const std::string_view rest = text.substr(kIdLength);
  if (rest.empty()) return true;
  return rest.size() >= 2 && rest.size() <= 10 && rest[0] == '.' && rest[1] >= '1' && rest[1] <= '9' &&
         rest != ".1" &&
         std::all_of(rest.begin() + 1, rest.end(), [](char c) { return c >= '0' && c <= '9'; });
}

RecordingCatalogue::RecordingCatalogue(Place folder, RecordingLimits limits)
    : folder_(std::move(folder)), limits_(limits) {}

// --- startup

void RecordingCatalogue::read_folder() {
  if (!on()) return;
  const std::lock_guard lock(mutex_);
  for (const std::string& name : folder_.names()) {
    const std::string_view file = name;
    // The note of a recording that has no frame.
    if (file.ends_with(".vtkhdf.json") && !(folder_ / file.substr(0, file.size() - kNote.size())).status()) {
      (folder_ / file).remove();
      continue;
    }
    if (!file.ends_with(kEnding)) continue;
    const std::string id(file.substr(0, file.size() - kEnding.size()));
    // Links lead to what is not this server's, and a FIFO would be waited for.
    if (!is_recording_id(id) || !place(id).is_regular()) continue;
    rows_[id].facts = read_note(place(id), id);
  }
}

void RecordingCatalogue::settle(Row& row, RecordingThread& thread) {
  RecordingFacts& f = row.facts;
  const RecoveryReport report = recover_recording(thread, place(f.id).path(), {});
  f.note = report.message;
  f.frames = report.frames_kept;
  switch (report.outcome) {
    case RecoveryOutcome::kIntact:
      // Complete, but its server ended before it could say so.
      f.state = RecordingFate::closed;
      break;
    case RecoveryOutcome::kRecovered:
      f.state = RecordingFate::repaired;
      log_warn("recording {} was not finished: {} of {} frames kept", f.id, report.frames_kept,
               report.frames_found);
      break;
    default:
      f.state = RecordingFate::damaged;
      log_error("recording {} could not be repaired: {}", f.id, report.message);
  }
}

void RecordingCatalogue::repair(RecordingThread& thread) {
  if (!on()) return;
  std::vector<Row> open;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, row] : rows_) {
      if (row.facts.state == RecordingFate::live || row.facts.state == RecordingFate::damaged)
        open.push_back(row);
    }
  }
  for (Row& row : open) {
    settle(row, thread);
    const std::lock_guard lock(mutex_);
    // A continuation that never got a frame holds nothing that its predecessor does not.
    if (row.facts.state == RecordingFate::repaired && row.facts.frames == 0 && number_of(row.facts.id) > 1) {
      rows_.erase(row.facts.id);
      remove_files(row.facts.id);
      continue;
    }
    write_note(row.facts);
    rows_[row.facts.id].facts = row.facts;
  }
}

// --- a recording being written

RecordingFacts RecordingCatalogue::begin(const std::string& session, const std::string& owner,
                                         const std::string& title, json::object asked) {
  const std::lock_guard lock(mutex_);
  if (limits_.most_bytes > 0) {
    double sum = 0;
    for (const auto& [id, row] : rows_) sum += present(row).bytes;
    if (sum >= limits_.most_bytes)
      throw Error("quota_exceeded", "recordings take " + short_number(sum / 1e6, 3) + " MB of the " +
                                        short_number(limits_.most_bytes / 1e6, 3) +
                                        " MB that this server keeps; delete some");
  }
  uint64_t number = 1;
  for (auto it = rows_.lower_bound(session); it != rows_.end() && it->second.facts.session == session; ++it)
    number = std::max(number, number_of(it->first) + 1);
  // A name is also taken while any file of that name remains, even without a note.
  const auto taken = [&](const std::string& id) {
    for (const std::string_view rest :
         {std::string_view(), kChunkLogEnding, std::string_view(".damaged"), kNote}) {
      if (place(id).with_ending(rest).status()) return true;
    }
    return false;
  };
  while (taken(name_of(session, number))) ++number;
  Row row;
  row.facts.id = name_of(session, number);
  row.facts.session = session;
  row.facts.owner = owner;
  row.facts.title = title;
  row.facts.created = static_cast<int64_t>(std::time(nullptr));
  row.facts.asked = std::move(asked);
  // Without it nobody would know whose it is.
  write_file(note_place(place(row.facts.id)), bytes_of(note_text(row.facts)), Durability::process);
  rows_[row.facts.id] = row;
  return row.facts;
}

void RecordingCatalogue::attach(const std::string& id, std::weak_ptr<const RecordingSink> sink) {
  const std::lock_guard lock(mutex_);
  const auto it = rows_.find(id);
  if (it != rows_.end()) it->second.sink = std::move(sink);
}

void RecordingCatalogue::forget(const std::string& id) {
  const std::lock_guard lock(mutex_);
  rows_.erase(id);
  remove_files(id);
}

void RecordingCatalogue::end(const std::string& id, RecordingFate state, uint64_t frames,
                             const std::string& note) {
  const std::lock_guard lock(mutex_);
  const auto it = rows_.find(id);
  if (it == rows_.end()) return;
  RecordingFacts& f = it->second.facts;
  f.state = state;
  f.frames = frames;
  f.note = note;
  it->second.sink.reset();
  write_note(f);
}

// On a full disk the old note remains and is corrected at the next start.
void RecordingCatalogue::write_note(const RecordingFacts& f) const {
  try {
    write_file(note_place(place(f.id)), bytes_of(note_text(f)), Durability::process);
  } catch (const Error& e) {
    log_warn("recording {}: {}", f.id, e.what());
  }
}

// --- lookup

RecordingFacts RecordingCatalogue::present(const Row& row) const {
  RecordingFacts f = row.facts;
  const auto about = place(f.id).status();
  f.bytes = about ? static_cast<double>(about->st_size) : 0;
  if (const auto sink = row.sink.lock()) {
    const RecordingStatus status = sink->status();
    f.frames = status.durable_frames;
    f.note = status.message;
    if (status.state == RecordingState::kFailed) f.state = RecordingFate::incomplete;
  }
  return f;
}

bool RecordingCatalogue::live(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto it = rows_.find(id);
  return it != rows_.end() && it->second.facts.state == RecordingFate::live;
}

RecordingFacts RecordingCatalogue::find(std::string_view id, const net::Caller& caller) const {
  const std::lock_guard lock(mutex_);
  const auto it = rows_.find(id);
  if (it == rows_.end() || !caller.may_see(it->second.facts.owner) || !place(it->first).is_regular())
    throw unknown();
  return present(it->second);
}

std::vector<RecordingFacts> RecordingCatalogue::of_session(const std::string& session) const {
  const std::lock_guard lock(mutex_);
  std::vector<RecordingFacts> out;
  for (auto it = rows_.lower_bound(session); it != rows_.end() && it->second.facts.session == session; ++it) {
    if (place(it->first).is_regular()) out.push_back(present(it->second));
  }
  std::sort(out.begin(), out.end(),
            [](const auto& a, const auto& b) { return number_of(a.id) > number_of(b.id); });
  return out;
}

std::optional<RecordingFacts> RecordingCatalogue::newest(const std::string& session) const {
  const auto all = of_session(session);
  return all.empty() ? std::nullopt : std::optional(all.front());
}

std::vector<RecordingFacts> RecordingCatalogue::list(std::string_view after, size_t limit,
                                                     const net::Caller& caller) const {
  const std::lock_guard lock(mutex_);
  std::vector<RecordingFacts> out;
  for (auto it = rows_.upper_bound(after); it != rows_.end() && out.size() < limit; ++it) {
    if (caller.may_see(it->second.facts.owner) && place(it->first).is_regular())
      out.push_back(present(it->second));
  }
  return out;
}

void RecordingCatalogue::remove(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const auto it = rows_.find(id);
  if (it == rows_.end()) throw unknown();
  const auto sink = it->second.sink.lock();
  if (it->second.facts.state == RecordingFate::live && sink &&
      sink->status().state == RecordingState::kRecording)
    throw Error("conflict", "the recording is being written; finish it first");
  const int code = place(id).remove();
  if (code && code != ENOENT) throw_file_error("remove the recording", code);
  rows_.erase(it);
  remove_files(id);
}

void RecordingCatalogue::remove_files(const std::string& id) const {
  const Place recording = place(id), damaged = recording.with_ending(".damaged");
  for (const Place& file : {recording, recording.with_ending(kChunkLogEnding), damaged,
                            damaged.with_ending(kChunkLogEnding), note_place(recording)})
    file.remove();
}

void RecordingCatalogue::sweep() {
  if (!on() || !limits_.keep) return;
  const auto oldest = static_cast<int64_t>(std::time(nullptr)) - limits_.keep->count();
  const std::lock_guard lock(mutex_);
  std::erase_if(rows_, [&](const auto& r) {
    const bool old = r.second.facts.state != RecordingFate::live && r.second.facts.created < oldest;
    if (old) remove_files(r.first);
    return old;
  });
}

}  // namespace truestep
