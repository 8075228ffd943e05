// JSON answers that the command line and the service share: what the program can do and what a scene amounts
// to.
#pragma once
#include <boost/json.hpp>

#include "engine/base/errors.h"
#include "engine/scene/admission.h"
#include "engine/scene/catalogue.h"
#include "engine/session/session.h"

namespace truestep {

/// {pointer, code, message, value, allowed, did_you_mean, unit}; empty members left out.
boost::json::object describe_issue(const Issue& issue);
boost::json::array describe_issues(const std::vector<Issue>& issues);
/// One system type with parameters, integrators, guarantees, and what it gives out: rows, fields,
/// observables.
boost::json::object describe_system(const CatalogueRow& row);
/// One line per system type.
boost::json::array describe_systems();
boost::json::object describe_integrator(const Integrator& method);
/// One line per gallery scene: name, title, teaches, tags.
boost::json::array describe_gallery();
/// {id, kind, fields, max_rows}, of a grid its lattice.
boost::json::object describe_part(const PartTable::Entry& part);
/// [{name, unit, width, type, meaning}]
boost::json::array describe_fields(const PartInfo& part);
/// {memory_bytes, elements, seconds_per_step}
boost::json::object describe_cost(const Cost& cost);
/// [{system, pass, runs, reason}]; seconds and share where profiles are given.
boost::json::array describe_plan(const World& world, std::span<const Profile> profiles);
/// {system, quantity, index, detail, last_good_step, remedies}, and suggested_dt where it is known.
boost::json::object describe_failure(const Failure& failure);
/// [{system, quantity, value, limit, detail, first_step, suggested_dt}]
boost::json::array describe_warnings(const std::vector<SessionWarning>& warnings);
boost::json::object describe_observables(const Observables& values);

/// What read_scene says and, where it found faults, those that only building shows (World::more_faults),
/// within `limits`: the whole list at once.
SceneReport examine_scene(const boost::json::value& document, const AdmissionLimits& limits);
/// The same for a report that reading has given.
SceneReport examine_further(SceneReport report, const AdmissionLimits& limits);

/// Everything about a scene document: valid, errors, warnings, plan, estimate, canonical scene. Never throws
/// for what a client can write.
boost::json::object validate_scene(const boost::json::value& document, const AdmissionLimits& limits);

}  // namespace truestep
