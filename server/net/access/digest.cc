#include "server/net/access/digest.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <sys/random.h>

#include "engine/base/errors.h"

namespace truestep::net {

std::array<uint8_t, 32> sha256(std::string_view data) {
  // Looked up once: libcrypto searches its providers for every algorithm that is named.
  static EVP_MD* const method = EVP_MD_fetch(nullptr, "SHA256", nullptr);
  std::array<uint8_t, 32> out;
  if (!method || !EVP_Digest(data.data(), data.size(), out.data(), nullptr, method, nullptr))
    throw Error("internal", "libcrypto has no SHA-256");
  return out;
}

std::string hex(const uint8_t* data, size_t size) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string out(2 * size, '0');
  for (size_t i = 0; i < size; ++i) {
    out[2 * i] = kDigits[data[i] >> 4];
    out[2 * i + 1] = kDigits[data[i] & 15];
  }
  return out;
}

std::string sha256_hex(std::string_view data) {
  const auto digest = sha256(data);
  return hex(digest.data(), digest.size());
}

bool equal_constant_time(std::string_view a, std::string_view b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

std::string random_hex128() {
  uint8_t bytes[16];
  size_t have = 0;
  while (have < sizeof bytes) {
    const ssize_t n = getrandom(bytes + have, sizeof bytes - have, 0);
    if (n > 0) have += static_cast<size_t>(n);
  }
  return hex(bytes, sizeof bytes);
}

}  // namespace truestep::net
