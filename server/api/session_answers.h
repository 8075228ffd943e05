// What several routes answer about a session: its description, its clock, and why it stopped.
#pragma once
#include <boost/json.hpp>
#include <string>

#include "server/api/app.h"
#include "server/net/http/message.h"
#include "server/sessions/step_request.h"

namespace truestep {

/// Paths of everything that belongs to the session.
boost::json::object links_of(const std::string& id);

/// Clock, status, systems with their fields, what the viewer needs, links. Under the entry's lock.
boost::json::object describe_session(SessionEntry& entry);

/// The problem for a request that another request, or shutdown, cut short. Under the entry's lock.
net::Response cut_short(const App& app, const net::Request& request, const SessionEntry& entry);

/// The problem "instability" of a session that has failed.
net::Response instability(const net::Request& request, const Session& session);

}  // namespace truestep
