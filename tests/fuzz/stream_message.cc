// Messages from clients of a stream: any bytes, in both wire forms, give a message or an Error with a code.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "engine/base/errors.h"
#include "server/stream/messages.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  for (const auto form : {truestep::WireForm::protobuf, truestep::WireForm::json}) {
    try {
      (void)truestep::client_message_from_wire(text, form);
    } catch (const truestep::Error& error) {
      if (error.code().empty()) __builtin_trap();
    }
  }
  return 0;
}
