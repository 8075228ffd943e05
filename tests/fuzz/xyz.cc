// XYZ texts: whatever the bytes are, they give as many names as positions, all finite, or an error in a line
// of the text or one that it lacks.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "engine/systems/molecular/xyz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace truestep::molecular;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const XyzAtoms atoms = read_xyz(text);
    if (atoms.names.size() != atoms.positions.size() || atoms.names.empty()) __builtin_trap();
    for (size_t i = 0; i < atoms.names.size(); ++i) {
      const truestep::Vec3& x = atoms.positions[i];
      if (atoms.names[i].empty() || !std::isfinite(x.x) || !std::isfinite(x.y) || !std::isfinite(x.z)) {
        __builtin_trap();
      }
    }
  } catch (const XyzFault& fault) {
    const auto lines = static_cast<size_t>(std::count(text.begin(), text.end(), '\n')) + 1;
    if (fault.line < 1 || fault.line > lines + 2) __builtin_trap();
  }
  return 0;
}
