// The version of this build, as answered by GET /version and written into recordings.
#pragma once
#include <string_view>

namespace truestep {

/// Semantic version, that of the project in CMakeLists.txt.
std::string_view version();
/// Compiler and flags that decide the bits of a result, e.g. "g++ 12.2.0 x86-64-v3 release".
std::string_view build_description();

}  // namespace truestep
