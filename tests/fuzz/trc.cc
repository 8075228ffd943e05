// Marker files: whatever the bytes are, they are read into positions of every frame and marker, or refused
// with a line that exists in the text.
#include <cstddef>
#include <cstdint>

#include "engine/geometry/read/trc.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace truestep;
  std::vector<std::string> lines(1);
  for (size_t k = 0; k < size; ++k) {
    if (data[k] == '\n') {
      lines.emplace_back();
    } else {
      lines.back() += static_cast<char>(data[k]);
    }
  }
  try {
    const MarkerTracks t = read_trc(lines);
    if (t.places.size() != t.frames * t.names.size() || t.seen.size() != t.places.size()) __builtin_trap();
  } catch (const TrcFault& fault) {
    if (fault.line < 1 || fault.line > lines.size() + 1) __builtin_trap();
  }
  return 0;
}
