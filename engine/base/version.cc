#include "engine/base/version.h"

namespace truestep {

#define TRUESTEP_TEXT2(x) #x
#define TRUESTEP_TEXT(x) TRUESTEP_TEXT2(x)

std::string_view version() {
  return TRUESTEP_VERSION;
}

std::string_view build_description() {
  return
#if defined(__clang__)
      "clang++ " TRUESTEP_TEXT(__clang_major__) "." TRUESTEP_TEXT(__clang_minor__)
#else
      "g++ " TRUESTEP_TEXT(__GNUC__) "." TRUESTEP_TEXT(__GNUC_MINOR__)
#endif
#if defined(__aarch64__)
          " arm64"
#else
          " x86-64-v3"
#endif
#if defined(__OPTIMIZE__)
          " optimised"
#else
          " unoptimised"
#endif
      // What the build was told to take other than usual, each with a blank in front.
      TRUESTEP_DEVIATIONS;
}

std::string_view deviations() {
  constexpr std::string_view kAll = TRUESTEP_DEVIATIONS;
  return kAll.empty() ? kAll : kAll.substr(1);
}

#undef TRUESTEP_TEXT
#undef TRUESTEP_TEXT2

}  // namespace truestep
