// Writes JSON with numbers as people write them: 0.01, not 1E-2; the shortest text that reads back as the
// same double.
#pragma once
#include <boost/json/value.hpp>
#include <string>

namespace truestep {

/// The document without white space. Numbers that are not finite become null, since JSON has none.
std::string write_json(const boost::json::value& value);

}  // namespace truestep
