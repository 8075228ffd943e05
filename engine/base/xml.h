// Text as XML and HTML want it.
#pragma once
#include <string>
#include <string_view>

namespace truestep {

/// The text with & < > " written as entities; control characters that XML 1.0 forbids are left out. Good as
/// character data and within double quotes.
std::string escaped_xml(std::string_view text);

}  // namespace truestep
