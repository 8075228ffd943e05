// Converts between JSON objects and structs described by parameter tables. All faults are collected; none
// stops the reading.
#pragma once
#include <boost/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/errors.h"
#include "engine/base/text/json_pointer.h"
#include "engine/base/text/nearest_name.h"
#include "engine/core/def/def.h"

namespace truestep {

/// Whether a struct holds what the document says. Unknown keys are faults of the document, but the struct is
/// still sound.
enum class Reading : uint8_t { sound, faulty };

/// Fills the struct `owner` described by `table` from `object`. `also_allowed` are keys that the caller reads
/// itself; keys that begin with x_ are ignored. Faults go to `issues` with pointers below `pointer`.
Reading read_params(const DefTable& table, void* owner, const boost::json::object& object,
                    const std::string& pointer, std::span<const std::string_view> also_allowed,
                    std::vector<Issue>& issues);

/// The struct as JSON with every value in SI, defaults included, absent optional values left out.
boost::json::object write_params(const DefTable& table, const void* owner);

/// JSON Schema (2020-12) of the object: properties, bounds, defaults, sentences, units under "x-unit".
boost::json::object schema_of(const DefTable& table);

/// The rows as a readable description: name, kind, unit, limits, default, sentence, choices, nested rows.
boost::json::array describe_params(const DefTable& table);

/// The value as JSON text of at most 80 characters.
std::string shorten(const boost::json::value& value);

}  // namespace truestep
