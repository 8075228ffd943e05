// A box has a spelling of its own in every table: half_extents about center or position, size from origin,
// low and high, or its edges as `box`. Each table reads the spellings of all others, and writes its own.
#pragma once
#include <boost/json.hpp>
#include <optional>
#include <span>
#include <string_view>

#include "engine/core/def/def.h"

namespace truestep {

/// The words for boxes that are not this table's own but that it reads; none where it has no box.
std::span<const std::string_view> other_box_words(const DefTable& table);

/// The object with its box in this table's own words; empty when it uses no others, when it gives the box
/// twice, or when what it gives are not lengths (the reader then says what is wrong with the words as they
/// are).
std::optional<boost::json::object> box_in_own_words(const DefTable& table, const boost::json::object& o);

}  // namespace truestep
