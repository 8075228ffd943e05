// What a picture or a stream shows over bodies on request.
#pragma once
#include <cstdint>

namespace truestep {

enum class Overlay : uint8_t { none = 0, contacts = 1, joints = 2, all = 3 };
constexpr Overlay operator|(Overlay a, Overlay b) {
  return static_cast<Overlay>(static_cast<uint8_t>(a) | static_cast<uint8_t>(b));
}
constexpr bool shows(Overlay wish, Overlay part) {
  return (static_cast<uint8_t>(wish) & static_cast<uint8_t>(part)) != 0;
}

}  // namespace truestep
