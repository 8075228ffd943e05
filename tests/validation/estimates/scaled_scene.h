// A scene with n times as much in it: more links, finer cloth, more particles; systems without a number that
// gives their amount are repeated n times.
#pragma once
#include <boost/json.hpp>

namespace truestep {

/// The document with everything that it generates made explicit in `times` the amount.
boost::json::value scaled_scene(const boost::json::value& document, int times);

}  // namespace truestep
