#include "server/persistence/sessions/session_folder.h"

#include <algorithm>
#include <cerrno>
#include <charconv>

#include "engine/base/errors.h"
#include "engine/base/hash.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "server/net/access/digest.h"
#include "server/persistence/files.h"

namespace truestep {

namespace json = boost::json;

namespace {

constexpr size_t kMostAbout = 64 << 10, kMostScene = size_t{256} << 20, kMostSnapshot = size_t{1} << 40;

[[noreturn]] void damaged(const Place& place, const char* what) {
  throw Error("session_damaged", "what is saved of session " + place.name() + " cannot be used: " + what);
}

std::string hash_of(std::string_view text) {
  Hasher h;
  h.bytes(text.data(), text.size());
  return hex64(h.value());
}

// "12" in "log.12"; empty when it is not a number.
std::optional<uint64_t> number_of(std::string_view text) {
  uint64_t v = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), v);
  if (error != std::errc() || end != text.data() + text.size() || text.empty()) return std::nullopt;
  return v;
}

// Splits "head.tail" at the last dot.
std::pair<std::string_view, std::string_view> split(std::string_view name) {
  const size_t dot = name.rfind('.');
  if (dot == std::string_view::npos) return {name, {}};
  return {name.substr(0, dot), name.substr(dot + 1)};
}

std::string text_member(const json::object& o, const char* name) {
  const json::value* v = o.if_contains(name);
  return v && v->is_string() ? std::string(v->as_string()) : std::string();
}

}  // namespace

SessionFolder SessionFolder::create(const Place& root, const SessionAbout& about, const json::object& scene,
                                    const json::object& accuracy) {
  const std::string body = write_json(json::object{{"scene", scene}, {"accuracy", accuracy}});
  const std::string line = write_json(json::object{{"id", about.id},
                                                   {"owner", about.owner},
                                                   {"title", about.title},
                                                   {"scene_hash", hex64(about.scene_hash)},
                                                   {"created", about.created},
                                                   {"sum", hash_of(body)}});
  const Place fresh = root / (".new-" + net::random_hex128()), place = root / about.id;
  fresh.make_folder();
  try {
    write_in_fresh_folder(SessionFolder(fresh).about_place(), bytes_of(line + "\n" + body));
    if (const int code = fresh.rename_to(place)) throw_file_error("name the folder of the session", code);
  } catch (...) {
    fresh.remove_all();
    throw;
  }
  return SessionFolder(place);
}

void SessionFolder::remove() const {
  const Place gone = place_.parent() / (".gone-" + net::random_hex128());
  const int code = place_.rename_to(gone);
  if (code == ENOENT) return;
  if (code) throw_file_error("remove the folder of the session", code);
  // What cannot be removed now is removed at the next start.
  gone.remove_all();
}

SessionAbout SessionFolder::about() const {
  // The scene behind the first line may be long, and a list of ten thousand sessions reads only those lines.
  const Bytes head = read_head(about_place(), kMostAbout);
  const std::string_view text = text_of(head);
  const size_t end = text.find('\n');
  if (end == std::string_view::npos) damaged(place_, "the description is cut off");
  SessionAbout about;
  try {
    const json::value line = parse_json(text.substr(0, end));
    const json::object& o = line.as_object();
    about.id = text_member(o, "id");
    about.owner = text_member(o, "owner");
    about.title = text_member(o, "title");
    about.scene_hash = std::stoull(text_member(o, "scene_hash"), nullptr, 16);
    about.created = o.at("created").to_number<int64_t>();
  } catch (const std::exception&) {
    damaged(place_, "the description is malformed");
  }
  if (about.id != place_.name()) damaged(place_, "it describes another session");
  return about;
}

double SessionFolder::bytes_to_read() const {
  double sum = 0;
  for (const std::string& name : place_.names()) {
    const auto about = (place_ / name).status();
    if (about && S_ISREG(about->st_mode)) sum += static_cast<double>(about->st_size);
  }
  return sum;
}

SessionFolder::Scene SessionFolder::scene() const {
  const Bytes file = read_file(about_place(), kMostScene);
  const std::string_view text = text_of(file);
  const size_t end = text.find('\n');
  if (end == std::string_view::npos) damaged(place_, "the description is cut off");
  const std::string_view body = text.substr(end + 1);
  try {
    const json::value line = parse_json(text.substr(0, end));
    if (text_member(line.as_object(), "sum") != hash_of(body)) damaged(place_, "the scene is damaged");
    json::value both = parse_json(body, {.max_bytes = kMostScene});
    json::object& o = both.as_object();
    return {std::move(o.at("scene")), std::move(o.at("accuracy").as_object())};
  } catch (const Error& e) {
    if (e.code() == "session_damaged") throw;
    damaged(place_, e.what());
  } catch (const std::exception&) {
    damaged(place_, "the scene is malformed");
  }
}

Place SessionFolder::state_place(uint64_t number, uint64_t step) const {
  return place_ / ("state." + std::to_string(number) + "." + std::to_string(step));
}

Place SessionFolder::log_place(uint64_t number) const {
  return place_ / ("log." + std::to_string(number));
}

SessionFolder::Contents SessionFolder::contents() const {
  Contents out;
  // Whether it can be read at all.
  place_.open(O_RDONLY | O_DIRECTORY, "read");
  for (const std::string& name : place_.names()) {
    const auto [head, tail] = split(name);
    const auto last = number_of(tail);
    if (!last) continue;
    if (head == "log") {
      out.logs.push_back(*last);
    } else if (head.starts_with("state.")) {
      if (const auto number = number_of(head.substr(6))) out.states[*number] = *last;
    }
  }
  std::sort(out.logs.begin(), out.logs.end());
  return out;
}

void SessionFolder::keep_snapshot(const std::string& sid, uint64_t step,
                                  std::span<const std::byte> file) const {
  const Place folder = place_ / "snapshots";
  folder.make_folder();
  write_file(folder / (sid + "." + std::to_string(step)), file, Durability::process);
}

std::map<std::string, uint64_t> SessionFolder::snapshots() const {
  std::map<std::string, uint64_t> out;
  for (const std::string& name : (place_ / "snapshots").names()) {
    const auto [sid, step] = split(name);
    if (const auto number = number_of(step)) out[std::string(sid)] = *number;
  }
  return out;
}

Bytes SessionFolder::snapshot(const std::string& sid, uint64_t step) const {
  return read_file(place_ / "snapshots" / (sid + "." + std::to_string(step)), kMostSnapshot);
}

}  // namespace truestep
