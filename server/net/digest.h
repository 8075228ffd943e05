// SHA-1 (FIPS 180-4, only for the WebSocket handshake), SHA-256 (keys, asset names), base64 (RFC 4648) and a
// comparison whose time does not depend on where two texts differ.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace truestep::net {

std::array<uint8_t, 20> sha1(std::string_view data);
std::array<uint8_t, 32> sha256(std::string_view data);

/// Lower-case hexadecimal digits.
std::string hex(const uint8_t* data, size_t size);
/// 64 lower-case hexadecimal digits of the SHA-256.
std::string sha256_hex(std::string_view data);

std::string base64_encode(const uint8_t* data, size_t size);
/// The decoded bytes; nullopt unless the text is canonical base64 with padding and nothing else.
std::optional<std::string> base64_decode(std::string_view text);

/// Equality in a time that depends on the lengths only.
bool equal_constant_time(std::string_view a, std::string_view b);

/// 32 random hexadecimal digits from the operating system's generator.
std::string random_hex128();

}  // namespace truestep::net
