#include "server/net/health.h"

#include <boost/asio/ip/tcp.hpp>
#include <string_view>

namespace truestep::net {

bool is_healthy(const std::string& url) {
  std::string_view rest = url;
  if (rest.starts_with("http://")) rest.remove_prefix(7);
  rest = rest.substr(0, rest.find('/'));
  const size_t colon = rest.rfind(':');
  const std::string host(rest.substr(0, colon)),
      port(colon == std::string_view::npos ? "80" : rest.substr(colon + 1));
  boost::asio::ip::tcp::iostream stream;
  stream.expires_after(std::chrono::seconds(3));
  stream.connect(host, port);
  stream << "GET /healthz HTTP/1.1\r\nHost: " << rest << "\r\nConnection: close\r\n\r\n" << std::flush;
  std::string line;
  std::getline(stream, line);
  return line.starts_with("HTTP/1.1 200");
}

}  // namespace truestep::net
