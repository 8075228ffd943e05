// What several routes read from a request: its JSON body, numbers in the query, a session under its lock.
#pragma once
#include <boost/json.hpp>
#include <functional>
#include <string>
#include <vector>

#include "server/api/app.h"
#include "server/sessions/members.h"
#include "server/tasks/offload.h"
#include "server/tasks/signal.h"

namespace truestep {

/// How long a request may take to be read.
inline constexpr std::chrono::seconds kReadingTime{120};

/// The body as strict JSON. Error unsupported_media unless it says application/json (or is empty, which
/// counts as {}).
boost::json::value json_body(const net::Request& request);
/// The same, elsewhere when the body is long.
Task<boost::json::value> long_json_body(App& app, const net::Request& request);
/// f(body) where neither reading the body nor what f does with it makes anybody wait: on a worker when the
/// body is short and names no assets, otherwise on the threads for long work, within a budget of bytes and
/// seconds (Error "quota_exceeded", "too_large"). The body ends there too.
template <class F>
auto with_json_body(App& app, const net::Request& request, F f) -> Task<decltype(f(boost::json::value()))>;
/// A body that takes no time worth speaking of, wherever it is read.
bool is_short(const net::Request& request);
/// The lease of what reading the request's body takes.
MemoryBudget::Lease body_lease(App& app, const net::Request& request);
/// An object; Error bad_request otherwise.
boost::json::object json_object_body(const net::Request& request);
boost::json::object object_of(boost::json::value body);

/// The session named by the path, restored from disk if necessary. Error "unknown_session",
/// "session_expired", or "creating" while a restore takes long.
Task<EntryPtr> session_of(App& app, const net::Request& request);
/// The operation named by the path. Error "unknown_operation".
OperationPtr operation_of(const App& app, const net::Request& request);
/// The Idempotency-Key, made unique per caller; empty when there is none. Error "bad_request" unless it has 1
/// to 255 visible ASCII characters.
std::string idempotency_key(const net::Request& request);

/// Carries out the request once for each of its Idempotency-Keys: a repeated one gets the answer of the
/// first. Without a key it is carried out at once. Errors "idempotency_key_reused", "conflict".
Task<net::Response> once(App& app, const net::Request& request,
                         std::function<Task<net::Response>()> carry_out);

/// An object with only these members ("step, time"); Error "bad_request" with a pointer to every other one. A
/// route that takes no members refuses any.
boost::json::object object_body_of(const net::Request& request,
                                   std::initializer_list<std::string_view> members);
/// A body sent without encoding. Error "unsupported_media" for a Content-Encoding, and for any Content-Type
/// other than `type` (for JSON also "+json"). An empty body has no type.
void require_media(const net::Request& request, std::string_view type);

/// Whether the request says that its body is JSON.
bool is_json(const net::Request& request);

/// An integer or number from the query; Error "bad_request" with the pointer "?name" when it is malformed,
/// below `min` (0 for numbers) or above `max`.
uint64_t query_integer(const net::Request& request, std::string_view name, uint64_t fallback, uint64_t min,
                       uint64_t max);
double query_number(const net::Request& request, std::string_view name, double fallback, double max);
/// "a,b,c" from the query; empty when absent.
std::vector<std::string> query_list(const net::Request& request, std::string_view name);

net::Response json_response(const boost::json::value& value, int status = 200);

using AnswerOfSession = std::function<net::Response(SessionEntry&)>;
/// f(entry) under the entry's lock: at once when the lock is free, otherwise on a worker, so that the network
/// thread never waits for a step.
Task<net::Response> with_session(App& app, EntryPtr entry, AnswerOfSession f);
/// The same with the session named by the path.
Task<net::Response> with_session(App& app, const net::Request& request, AnswerOfSession f);
/// The same, always on a worker: for slow work.
Task<net::Response> with_session_on_worker(App& app, EntryPtr entry, AnswerOfSession f);
/// The same on the threads for long work: for what costs as much as the request is long.
Task<net::Response> with_session_in_long_work(App& app, EntryPtr entry, AnswerOfSession f);
/// f(entry) after cancelling everything that was requested of the session.
Task<> interrupt_and_call(App& app, EntryPtr entry, std::function<void(SessionEntry&)> f);

template <class F>
auto with_json_body(App& app, const net::Request& request, F f) -> Task<decltype(f(boost::json::value()))> {
  auto work = [&request, f = std::move(f)]() mutable { return f(json_body(request)); };
  if (is_short(request)) co_return co_await offload(app.runner.pool(), std::move(work));
  const auto lease = body_lease(app, request);
  co_return co_await app.runner.long_work(std::move(work), kReadingTime);
}

}  // namespace truestep
