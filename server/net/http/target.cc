// Path and query of a request target, RFC 3986 sections 2.1, 3.3 and 3.4; query as HTML forms send it ('+' is
// a space). A path is split before it is decoded, so an encoded slash is data and never a separator.
#include "engine/base/text/utf8.h"
#include "server/net/http/characters.h"
#include "server/net/http/request_parser.h"

namespace truestep::net {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  const char l = static_cast<char>(c | 32);
  return l >= 'a' && l <= 'f' ? l - 'a' + 10 : -1;
}

enum class Plus { keep, space };

// Decodes into `store` (whose capacity never moves) when needed; false on a bad escape or a control
// character.
bool decode(std::string_view in, std::string& store, std::string_view& out, Plus plus) {
  static constexpr Characters kCoded("%+");
  if (!kCoded.has_any_of(in)) {
    out = in;
    return true;
  }
  const size_t begin = store.size();
  for (size_t i = 0; i < in.size(); ++i) {
    char c = in[i];
    if (c == '%') {
      if (i + 2 >= in.size()) return false;
      const int high = hex_digit(in[i + 1]), low = hex_digit(in[i + 2]);
      if (high < 0 || low < 0) return false;
      c = static_cast<char>(high << 4 | low);
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) return false;
      i += 2;
    } else if (c == '+' && plus == Plus::space) {
      c = ' ';
    }
    store += c;
  }
  out = std::string_view(store).substr(begin);
  return valid_utf8(out);
}

}  // namespace

bool split_target(Request& request) {
  request.decoded_.clear();
  // Decoding never lengthens, so the views below stay valid.
  request.decoded_.reserve(request.target.size());
  const size_t question = request.target.find('?');
  request.raw_path = request.target.substr(0, question);
  std::string_view path = request.raw_path;
  while (path.size() > 1 || !request.segments.empty()) {
    path = path.substr(1);  // the slash
    const size_t slash = std::min(path.find('/'), path.size());
    std::string_view segment;
    if (!decode(path.substr(0, slash), request.decoded_, segment, Plus::keep)) return false;
    if (segment == "." || segment == "..") return false;
    request.segments.push_back(segment);
    path.remove_prefix(slash);
    if (path.empty()) break;
  }
  if (question == std::string_view::npos) return true;
  std::string_view rest = request.target.substr(question + 1);
  while (!rest.empty()) {
    const size_t amp = std::min(rest.find('&'), rest.size());
    const std::string_view pair = rest.substr(0, amp);
    rest.remove_prefix(std::min(amp + 1, rest.size()));
    if (pair.empty()) continue;
    const size_t equal = std::min(pair.find('='), pair.size());
    Field f;
    if (!decode(pair.substr(0, equal), request.decoded_, f.name, Plus::space)) return false;
    if (!decode(pair.substr(std::min(equal + 1, pair.size())), request.decoded_, f.value, Plus::space))
      return false;
    request.query.push_back(f);
  }
  return true;
}

}  // namespace truestep::net
