// Sets of characters by a table: what every request is checked for, a load per character.
#pragma once
#include <array>
#include <string_view>

namespace truestep::net {

class Characters {
 public:
  constexpr explicit Characters(std::string_view members) {
    for (const char c : members) has_[static_cast<unsigned char>(c)] = true;
  }
  /// Printable ASCII except for these.
  static constexpr Characters printable_but(std::string_view others) {
    Characters all("");
    for (size_t c = 0x21; c < 0x7F; ++c) all.has_[c] = true;
    for (const char c : others) all.has_[static_cast<unsigned char>(c)] = false;
    return all;
  }
  constexpr bool has(char c) const { return has_[static_cast<unsigned char>(c)]; }
  constexpr bool has_all_of(std::string_view text) const {
    for (const char c : text) {
      if (!has(c)) return false;
    }
    return true;
  }
  constexpr bool has_any_of(std::string_view text) const {
    for (const char c : text) {
      if (has(c)) return true;
    }
    return false;
  }

 private:
  std::array<bool, 256> has_{};
};

}  // namespace truestep::net
