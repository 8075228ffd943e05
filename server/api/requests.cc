#include "server/api/requests.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <mutex>

#include "engine/base/hash.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "engine/scene/params/params.h"

namespace truestep {

namespace json = boost::json;

namespace {

constexpr size_t kShortBody = 32 << 10;
// A value takes about 25 bytes and is copied once while its array grows.
constexpr double kMemoryPerByte = 3.5;

[[noreturn]] void bad_query(std::string_view name, std::string_view value, const std::string& allowed) {
  throw Error("bad_request", "the query parameter " + std::string(name) + " is out of range",
              {{"?" + std::string(name), "out_of_range", "the value is outside the allowed range",
                '"' + std::string(value.substr(0, 60)) + '"', allowed, "", ""}});
}

template <class T>
T parse_query(const net::Request& request, std::string_view name, T fallback, T min, T max,
              const char* kind) {
  const auto text = request.query_value(name);
  if (!text) return fallback;
  T value{};
  const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), value);
  const bool good =
      error == std::errc() && end == text->data() + text->size() && value >= min && value <= max;
  if (!good)
    bad_query(
        name, *text,
        std::string(kind) + " from " + write_json(json::value(min)) + " to " + write_json(json::value(max)));
  return value;
}

}  // namespace

namespace {
constexpr std::string_view kJsonType = "application/json";

// The media type without its parameters.
std::string_view media_type(const net::Request& request) {
  const std::string_view sent = request.header("content-type");
  return net::trim(sent.substr(0, sent.find(';')));
}
}  // namespace

bool is_json(const net::Request& request) {
  const std::string_view type = media_type(request);
  return net::iequals(type, kJsonType) || type.ends_with("+json");
}

void require_media(const net::Request& request, std::string_view type) {
  if (request.body.empty()) return;
  const std::string_view coding = request.header("content-encoding");
  if (!coding.empty() && !net::iequals(coding, "identity"))
    throw Error("unsupported_media", "encoded bodies are not supported: send them without Content-Encoding");
  if (net::iequals(media_type(request), type) || (type == kJsonType && is_json(request))) return;
  throw Error("unsupported_media", "the body must come with Content-Type: " + std::string(type));
}

json::value json_body(const net::Request& request) {
  if (request.body.empty()) return json::object{};
  require_media(request, kJsonType);
  // About 64 MB of memory.
  constexpr size_t kMostValues = 1'200'000;
  return parse_json(request.body, {.max_values = kMostValues});
}

bool is_short(const net::Request& request) {
  return request.body.size() <= kShortBody && request.body.find("\"asset\"") == std::string::npos;
}

MemoryBudget::Lease body_lease(App& app, const net::Request& request) {
  return app.memory.lease(kMemoryPerByte * static_cast<double>(request.body.size()), "reading the body");
}

Task<json::value> long_json_body(App& app, const net::Request& request) {
  if (request.body.size() <= kShortBody) co_return json_body(request);
  const auto lease = body_lease(app, request);
  auto parse = [&request] { return json_body(request); };
  co_return co_await app.runner.long_work(std::move(parse), kReadingTime);
}

json::object json_object_body(const net::Request& request) {
  if (request.body.size() > kShortBody)
    throw Error("too_large", "this request takes a body of at most " + std::to_string(kShortBody) + " bytes");
  return object_of(json_body(request));
}

json::object object_of(json::value v) {
  if (!v.is_object())
    throw Error("bad_request", "the body must be a JSON object",
                {{"", "wrong_type", "the body must be a JSON object", "", "an object", "", ""}});
  return std::move(v.as_object());
}

OperationPtr operation_of(const App& app, const net::Request& request) {
  return app.operations.find(request.param("id"), request.caller);
}

std::string idempotency_key(const net::Request& request) {
  constexpr std::string_view kName = "idempotency-key";
  if (!request.has_header(kName)) return {};
  const std::string_view key = request.header(kName);
  size_t given = 0;
  for (const net::Field& f : request.headers) given += net::iequals(f.name, kName);
  const bool visible = std::all_of(key.begin(), key.end(), [](char c) { return c > ' ' && c <= '~'; });
  if (key.empty() || key.size() > 255 || !visible || given > 1)
    throw Error("bad_request",
                "an Idempotency-Key must have 1 to 255 visible ASCII characters and be given once");
  return request.caller.name + '\n' + std::string(key);
}

namespace {
std::string location_of(const net::Response& r) {
  constexpr std::string_view kName = "Location: ";
  const std::string& all = r.header_block();
  const size_t at = all.find(kName);
  if (at == std::string::npos) return {};
  const size_t begin = at + kName.size();
  return all.substr(begin, all.find('\r', begin) - begin);
}
}  // namespace

Task<net::Response> once(App& app, const net::Request& request,
                         std::function<Task<net::Response>()> carry_out) {
  const std::string key = idempotency_key(request);
  if (key.empty()) co_return co_await carry_out();
  auto hash = [&request] {
    Hasher hasher;
    hasher.text(request.method_text);
    hasher.text(request.raw_path);
    hasher.text(request.body);
    return hasher.value();
  };
  // A gigabyte takes about a second.
  const uint64_t known = is_short(request) ? hash() : co_await offload(app.runner.pool(), hash);
  if (const auto before = app.idempotency.begin(key, known)) {
    net::Response r = net::Response::json(before->body, before->status);
    r.content_type = before->media;
    if (!before->location.empty()) r.header("Location", before->location);
    if (before->status == 202) r.header("Retry-After", "1");
    co_return r;
  }
  try {
    net::Response made = co_await carry_out();
    app.idempotency.remember(
        key, {known, made.status, std::string(made.body_bytes()), location_of(made), made.content_type});
    co_return made;
  } catch (...) {
    app.idempotency.forget(key);
    throw;
  }
}

json::object object_body_of(const net::Request& request, std::initializer_list<std::string_view> members) {
  json::object body = json_object_body(request);
  require_members(body, {members.begin(), members.size()});
  return body;
}

uint64_t query_integer(const net::Request& request, std::string_view name, uint64_t fallback, uint64_t min,
                       uint64_t max) {
  return parse_query<uint64_t>(request, name, fallback, min, max, "an integer");
}

double query_number(const net::Request& request, std::string_view name, double fallback, double max) {
  return parse_query<double>(request, name, fallback, 0, max, "a number");
}

std::vector<std::string> query_list(const net::Request& request, std::string_view name) {
  std::vector<std::string> out;
  std::string_view text = request.query_value(name).value_or("");
  while (!text.empty() && out.size() < 64) {
    const size_t comma = text.find(',');
    if (comma != 0) out.emplace_back(text.substr(0, comma));
    text = comma == std::string_view::npos ? "" : text.substr(comma + 1);
  }
  return out;
}

Task<net::Response> with_session(App& app, EntryPtr entry, AnswerOfSession f) {
  // A step that is not logged yet is logged on a worker, because the network threads never wait for a disk.
  if (std::unique_lock lock(entry->mutex, std::try_to_lock); lock.owns_lock() && entry->acknowledged())
    co_return entry->use(f);
  co_return co_await with_session_on_worker(app, std::move(entry), std::move(f));
}

Task<net::Response> with_session(App& app, const net::Request& request, AnswerOfSession f) {
  EntryPtr entry = co_await session_of(app, request);
  co_return co_await with_session(app, std::move(entry), std::move(f));
}

namespace {

net::Response answer_of(SessionEntry& entry, const AnswerOfSession& f) {
  const std::lock_guard lock(entry.mutex);
  return entry.use([&f](SessionEntry& e) {
    net::Response response = f(e);
    e.acknowledge();
    return response;
  });
}

}  // namespace

Task<net::Response> with_session_on_worker(App& app, EntryPtr entry, AnswerOfSession f) {
  auto work = [&] { return answer_of(*entry, f); };
  co_return co_await offload(app.runner.pool(), std::move(work));
}

Task<net::Response> with_session_in_long_work(App& app, EntryPtr entry, AnswerOfSession f) {
  auto work = [&] { return answer_of(*entry, f); };
  co_return co_await app.runner.long_work(std::move(work), kReadingTime);
}

Task<> interrupt_and_call(App& app, EntryPtr entry, std::function<void(SessionEntry&)> f) {
  // The network thread does not wait for the lock, and the job comes before later requests.
  const JobPtr job = Job::between_steps(std::move(f));
  auto work = [&] {
    {
      const std::lock_guard lock(entry->mutex);
      app.runner.interrupt(*entry);
    }
    return app.runner.start(entry, job);
  };
  co_await offload(app.runner.pool(), std::move(work));
  co_await app.runner.end_of(entry, job);
}

net::Response json_response(const json::value& value, int status) {
  return net::Response::json(write_json(value), status);
}

}  // namespace truestep
