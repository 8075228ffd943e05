// Text escaped for XML and HTML.
#pragma once
#include <string>
#include <string_view>

namespace truestep {

/// The text with & < > " written as entities; control characters forbidden by XML 1.0 are dropped. Safe as
/// character data and within double quotes.
std::string escaped_xml(std::string_view text);

}  // namespace truestep
