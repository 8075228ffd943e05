// A scene with n times as much in it: more links, finer cloth, more particles; what has no number that says
// how much there is, is there n times.
#pragma once
#include <boost/json.hpp>

namespace truestep {

/// The document with everything that it makes made explicit in `times` the amount.
boost::json::value scaled_scene(const boost::json::value& document, int times);

}  // namespace truestep
