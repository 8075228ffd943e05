// Addresses as texts.
#pragma once
#include <string>
#include <string_view>

namespace truestep::net {

/// An IPv4 or IPv6 address, without brackets or port.
bool is_address(std::string_view text);
/// "localhost" or an address of this machine only.
bool is_loopback(std::string_view host);
/// The part of "address:port" that identifies one person: an IPv4 address, or the first 64 bits of an IPv6
/// address.
std::string network_of(std::string_view remote);

}  // namespace truestep::net
