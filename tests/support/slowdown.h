// How much slower than optimized code a build may run: time budgets in tests are given in optimized seconds.
// 15 is generous: with 1, a study's budget ended before its reference was known, under clang's address
// sanitizer at -O1.
#pragma once

namespace truestep {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr int kSlowdown = 15;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
inline constexpr int kSlowdown = 15;
#else
inline constexpr int kSlowdown = 1;
#endif
#else
inline constexpr int kSlowdown = 1;
#endif

}  // namespace truestep
