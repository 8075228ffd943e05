// SHA-256 (FIPS 180-4; for keys and asset names) and a comparison whose time does not depend on where two
// texts differ, both by OpenSSL's libcrypto.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace truestep::net {

std::array<uint8_t, 32> sha256(std::string_view data);

/// Lower-case hexadecimal digits.
std::string hex(const uint8_t* data, size_t size);
/// 64 lower-case hexadecimal digits of the SHA-256.
std::string sha256_hex(std::string_view data);

/// Equality in a time that depends on the lengths only.
bool equal_constant_time(std::string_view a, std::string_view b);

/// 32 random hexadecimal digits from the operating system's generator.
std::string random_hex128();

}  // namespace truestep::net
