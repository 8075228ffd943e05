// The text of proto/truestep/v1/stream.proto, for clients in other languages.
#pragma once
#include <string_view>

namespace truestep {

std::string_view stream_proto();

}  // namespace truestep
