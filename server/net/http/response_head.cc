#include "server/net/http/response_head.h"

#include <boost/beast/http/status.hpp>
#include <charconv>
#include <ctime>

namespace truestep::net {
namespace {

// The Date line of the current second; one copy per thread.
std::string_view date_line() {
  thread_local std::time_t second = 0;
  thread_local std::string line;
  timespec now;
  clock_gettime(CLOCK_REALTIME_COARSE, &now);
  if (now.tv_sec != second) {
    second = now.tv_sec;
    line = "Date: " + http_date(second) + "\r\n";
  }
  return line;
}

void append_number(std::string& out, uint64_t n) {
  char digits[24];
  out.append(digits, std::to_chars(digits, digits + sizeof digits, n).ptr);
}

}  // namespace

std::string http_date(std::time_t time) {
  constexpr const char* kDays[] = {"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
  constexpr const char* kMonths[] = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                     "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  std::tm t{};
  gmtime_r(&time, &t);
  char text[64];
  const int n = std::snprintf(text, sizeof text, "%s, %02d %s %04d %02d:%02d:%02d GMT", kDays[t.tm_wday],
                              t.tm_mday, kMonths[t.tm_mon], t.tm_year + 1900, t.tm_hour, t.tm_min, t.tm_sec);
  return std::string(text, static_cast<size_t>(n));
}

void append_head(std::string& out, const Response& r, uint64_t content_length, ConnectionFate fate) {
  append_number(out += "HTTP/1.1 ", static_cast<uint64_t>(r.status));
  out += ' ';
  out += boost::beast::http::obsolete_reason(static_cast<boost::beast::http::status>(r.status));
  out += "\r\n";
  out += date_line();
  if (!r.content_type.empty()) {
    out += "Content-Type: ";
    out += r.content_type;
    out += "\r\nX-Content-Type-Options: nosniff\r\n";
  }
  if (std::holds_alternative<StreamBody>(r.body)) {
    // Ended by closing the connection when the client does not know chunked coding.
    if (fate != ConnectionFate::close) out += "Transfer-Encoding: chunked\r\n";
  } else if (r.status != 204 && r.status != 304) {
    append_number(out += "Content-Length: ", content_length);
    out += "\r\n";
  }
  if (!r.etag.empty()) {
    out += "ETag: ";
    out += r.etag;
    out += "\r\n";
  }
  out += r.header_block();
  if (fate == ConnectionFate::close) {
    out += "Connection: close\r\n";
  } else if (fate == ConnectionFate::keep_http10) {
    out += "Connection: keep-alive\r\n";
  }
  out += "\r\n";
}

}  // namespace truestep::net
