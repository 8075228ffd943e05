// Parameters as text, as describe_params tells them.
#pragma once
#include <boost/json.hpp>
#include <iosfwd>

namespace truestep {

/// brief: members of members by name only, and what all variants of a list take once. whole: everything in
/// its place.
enum class Detail : uint8_t { brief, whole };

void print_parameters(std::ostream& out, const boost::json::array& rows, Detail detail);

}  // namespace truestep
