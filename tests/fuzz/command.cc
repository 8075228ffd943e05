// Commands: any text gives a command or an Error with a code; an accepted one survives being written and
// read.
#include <boost/json/serialize.hpp>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "engine/scene/json/json.h"
#include "engine/session/commands.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  try {
    const auto document = truestep::parse_json({reinterpret_cast<const char*>(data), size});
    const auto once = truestep::write_command(truestep::read_command(document));
    const auto again = truestep::write_command(truestep::read_command(once));
    if (boost::json::serialize(once) != boost::json::serialize(again)) __builtin_trap();
  } catch (const truestep::Error& error) {
    if (error.code().empty()) __builtin_trap();
  }
  return 0;
}
