// Motion files: whatever the bytes are, they are read, written and read again as the same motion, or refused
// with a line that the text has.
#include <cstddef>
#include <cstdint>

#include "engine/geometry/read/bvh.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace truestep;
  const auto lines_of = [](const auto* text, size_t length) {
    std::vector<std::string> out(1);
    for (size_t k = 0; k < length; ++k) {
      if (text[k] == '\n') {
        out.emplace_back();
      } else {
        out.back() += static_cast<char>(text[k]);
      }
    }
    return out;
  };
  const std::vector<std::string> lines = lines_of(data, size);
  try {
    const BvhMotion motion = read_bvh(lines);
    if (motion.values.size() != motion.frames * motion.channels) __builtin_trap();
    for (size_t j = 0; j < motion.joints.size(); ++j) motion.local(motion.frames - 1, j);
    const std::string text = write_bvh(motion);
    if (read_bvh(lines_of(text.data(), text.size())).values != motion.values) __builtin_trap();
  } catch (const BvhFault& fault) {
    if (fault.line < 1 || fault.line > lines.size() + 1) __builtin_trap();
  }
  return 0;
}
