#include "server/net/inflate.h"

#include <boost/beast/zlib/error.hpp>
#include <charconv>

namespace truestep::net {
namespace {

namespace zlib = boost::beast::zlib;

// Takes the text before the separator off the front.
std::string_view take_item(std::string_view& list, char separator) {
  const size_t end = std::min(list.find(separator), list.size());
  const std::string_view item = trim(list.substr(0, end));
  list.remove_prefix(std::min(end + 1, list.size()));
  return item;
}

// One offer "permessage-deflate; a; b=1": the parameters of RFC 7692 section 7.1, each at most once.
std::optional<std::string> answer_offer(std::string_view offer) {
  if (!iequals(take_item(offer, ';'), "permessage-deflate")) return std::nullopt;
  std::string answer = "permessage-deflate; server_no_context_takeover; client_no_context_takeover";
  enum : unsigned { kServerTakeover = 1, kClientTakeover = 2, kServerBits = 4, kClientBits = 8 };
  unsigned seen = 0;
  while (!offer.empty()) {
    std::string_view value = take_item(offer, ';');
    const bool has_value = value.find('=') != std::string_view::npos;
    const std::string_view name = take_item(value, '=');
    if (value.size() >= 2 && value.front() == '"' && value.back() == '"')
      value = value.substr(1, value.size() - 2);
    int bits = 0;
    const bool good_bits =
        std::from_chars(value.data(), value.data() + value.size(), bits).ptr == value.data() + value.size() &&
        bits >= 8 && bits <= 15 && !value.empty() && value[0] != '0';
    unsigned flag = 0;
    if (name == "server_no_context_takeover" && !has_value) {
      flag = kServerTakeover;
    } else if (name == "client_no_context_takeover" && !has_value) {
      flag = kClientTakeover;
    } else if (name == "server_max_window_bits" && good_bits) {
      flag = kServerBits;
      answer += "; server_max_window_bits=" + std::to_string(bits);
    } else if (name == "client_max_window_bits" && (!has_value || good_bits)) {
      flag = kClientBits;
    }
    if (flag == 0 || (seen & flag)) return std::nullopt;
    seen |= flag;
  }
  return answer;
}

}  // namespace

InflateResult Inflater::run(std::string_view compressed, size_t limit, std::string& out) {
  stream_.reset();
  out.clear();
  // The sender cut an empty stored block off the end (RFC 7692 section 7.2.1).
  const std::string_view pieces[] = {compressed, {"\0\0\xff\xff", 4}};
  for (const std::string_view piece : pieces) {
    zlib::z_params z{};
    z.next_in = piece.data();
    z.avail_in = piece.size();
    for (;;) {
      const size_t have = out.size();
      // One byte beyond the limit is enough to know that it is exceeded.
      const size_t room = std::min(std::max<size_t>(4 * piece.size(), 1024), limit + 1 - have);
      if (room == 0) return InflateResult::too_large;
      out.resize(have + room);
      z.next_out = out.data() + have;
      z.avail_out = room;
      boost::system::error_code ec;
      stream_.write(z, zlib::Flush::sync, ec);
      out.resize(have + room - z.avail_out);
      if (out.size() > limit) return InflateResult::too_large;
      if (ec == zlib::error::end_of_stream) return InflateResult::good;
      if (ec && ec != zlib::error::need_buffers) return InflateResult::bad;
      if (z.avail_in == 0 && z.avail_out > 0) break;
      if (ec) return InflateResult::bad;  // no progress with room on both sides
    }
  }
  return InflateResult::good;
}

std::optional<std::string> negotiate_deflate(const Request& request) {
  for (const Field& f : request.headers) {
    if (!iequals(f.name, "sec-websocket-extensions")) continue;
    for (std::string_view offers = f.value; !offers.empty();) {
      if (auto answer = answer_offer(take_item(offers, ','))) return answer;
    }
  }
  return std::nullopt;
}

}  // namespace truestep::net
