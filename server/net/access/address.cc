#include "server/net/access/address.h"

#include <algorithm>
#include <boost/asio/ip/address.hpp>

namespace truestep::net {

namespace asio = boost::asio;

bool is_address(std::string_view text) {
  boost::system::error_code ec;
  asio::ip::make_address(std::string(text), ec);
  return !ec;
}

bool is_loopback(std::string_view host) {
  if (host == "localhost") return true;
  boost::system::error_code ec;
  const auto address = asio::ip::make_address(std::string(host), ec);
  return !ec && address.is_loopback();
}

std::string network_of(std::string_view remote) {
  const size_t colon = remote.rfind(':');
  std::string_view host = remote.substr(0, colon);
  if (host.starts_with('[')) host = host.substr(1, host.find(']') - 1);
  boost::system::error_code ec;
  const auto address = asio::ip::make_address(std::string(host), ec);
  if (ec || address.is_v4()) return std::string(host);
  if (address.to_v6().is_v4_mapped())
    return asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6()).to_string();
  auto bytes = address.to_v6().to_bytes();
  std::fill(bytes.begin() + 8, bytes.end(), uint8_t{0});
  return asio::ip::make_address_v6(bytes).to_string();
}

}  // namespace truestep::net
