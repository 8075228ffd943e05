// Serialised states: any bytes give a state or Error "bad_snapshot"; a state that was read is written back to
// bytes that give an equal state.
#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/base/errors.h"
#include "engine/core/state/state.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  try {
    const auto state = truestep::State::deserialize(std::as_bytes(std::span(data, size)));
    if (!(truestep::State::deserialize(state.serialize()) == state)) __builtin_trap();
  } catch (const truestep::Error& error) {
    if (error.code() != "bad_snapshot") __builtin_trap();
  }
  return 0;
}
