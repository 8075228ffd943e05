// The version of this build, as answered by GET /version and written into recordings.
#pragma once
#include <string_view>

namespace truestep {

/// Semantic version, that of the project in CMakeLists.txt.
std::string_view version();
/// Compiler, flags and options that decide the bits of a result, e.g. "g++ 12.2 x86-64-v3 optimised".
std::string_view build_description();
/// Options of the build with which results differ in their last bits from those of other programs of this
/// version: empty, or "sparse=eigen".
std::string_view deviations();

}  // namespace truestep
