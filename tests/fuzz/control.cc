// A planted bug: reads past the end of a buffer once the input begins with three given bytes. A fuzzing run
// that does not find it can find nothing.
#include <cstddef>
#include <cstdint>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::vector<uint8_t> copy(data, data + size);
  if (size >= 3 && copy[0] == 'b' && copy[1] == 'u' && copy[2] == 'g') {
    volatile uint8_t past = copy.data()[size];
    return past & 0;
  }
  return 0;
}
