// Variations of a scene document: other methods, other steps, other parameters.
#pragma once
#include <boost/json.hpp>
#include <string>
#include <string_view>

#include "engine/session/world/world.h"
#include "engine/studies/study.h"

namespace truestep {

/// Sets `value` at an RFC 6901 pointer; null removes a member. A token * stands for every element of an
/// array. Missing members of objects are created, elements of arrays must exist ("-" does not append). Error
/// "bad_pointer" with the pointer otherwise.
void set_at(boost::json::value& document, std::string_view pointer, boost::json::value value);

/// Sets the session step to dt, without substeps.
void set_dt(boost::json::value& document, double dt);
/// Sets the integrator of system `system` (an index).
void set_integrator(boost::json::value& document, size_t system, std::string_view name);
/// Sets the error tolerance of that system's adaptive method: relative, and absolute in the units of its
/// columns.
void set_tolerance(boost::json::value& document, size_t system, double tolerance);

/// The scene of a document; Error "scene_invalid", or whatever the study's context throws at its cost.
Scene read_variant(const boost::json::value& document, const StudyContext& context);
/// The world of a document; the same errors.
World build_world(const boost::json::value& document, const StudyContext& context);

/// Index of the system that a study is about: the one named `id`, or the first that takes an integrator when
/// the id is empty. Error "scene_invalid" with pointer "/system".
size_t studied_system(const Scene& scene, std::string_view id);

}  // namespace truestep
