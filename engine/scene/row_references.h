// Ids where a scene may give rows: of bodies and joints in "joints", in couplings and in probes. They are
// turned into rows before parameters are read, so that the scene that is stored and shown holds rows only.
#pragma once
#include <boost/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/errors.h"
#include "engine/scene/scene.h"

namespace truestep {

/// The system's object with rows for ids of its own bodies and joints; none if it gives no ids. An id that
/// there is not is a fault.
std::optional<boost::json::object> with_own_rows(const boost::json::object& system, const CatalogueRow& row,
                                                 const std::string& where, std::vector<Issue>& errors);

/// The coupling's object with rows for ids of bodies of its sides, and 0 and -1 for "first" and "last".
boost::json::object with_rows_of_sides(const boost::json::object& coupling, const CouplingRow& row,
                                       const SceneSystem& a, const SceneSystem& b, const std::string& where,
                                       std::vector<Issue>& errors);

/// The scene's header with 0 for the ids of bodies in "index" of its probes, as it is read before the
/// systems; none if there are no such ids ...
std::optional<boost::json::object> without_names_of_probes(const boost::json::object& scene);
/// ... and the rows, once there are systems.
void name_rows_of_probes(const boost::json::object& document, Scene& scene, std::vector<Issue>& errors);

/// A scene's schema in which ids are allowed where they are.
void allow_ids(boost::json::object& schema);

}  // namespace truestep
