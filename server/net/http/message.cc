#include "server/net/http/message.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "engine/base/errors.h"
#include "engine/base/hash.h"
#include "server/net/access/digest.h"

namespace truestep::net {
namespace {

constexpr std::string_view kMethodNames[kMethods] = {"GET",   "HEAD",   "POST",    "PUT",
                                                     "PATCH", "DELETE", "OPTIONS", ""};

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
}

// Calls visit(item) for every non-empty item of a comma-separated list until it returns true.
template <class Visit>
bool any_item(std::string_view list, Visit&& visit) {
  while (!list.empty()) {
    const size_t comma = list.find(',');
    const std::string_view item = trim(list.substr(0, comma));
    if (!item.empty() && visit(item)) return true;
    if (comma == std::string_view::npos) break;
    list.remove_prefix(comma + 1);
  }
  return false;
}

// "type/subtype;q=0" or with any zero after the point refuses the type.
bool refused_by_quality(std::string_view parameters) {
  const size_t q = parameters.find("q=");
  if (q == std::string_view::npos) return false;
  const std::string_view value = parameters.substr(q + 2);
  return !value.empty() && value.find_first_of("123456789") == std::string_view::npos;
}

}  // namespace

std::string_view method_name(Method m) {
  return kMethodNames[static_cast<size_t>(m)];
}

Method method_from(std::string_view name) {
  for (size_t i = 0; i + 1 < kMethods; ++i) {
    if (kMethodNames[i] == name) return static_cast<Method>(i);
  }
  return Method::other;
}

bool iequals(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  for (size_t i = 0; i < a.size(); ++i) {
    if (lower(a[i]) != lower(b[i])) return false;
  }
  return true;
}

std::string_view trim(std::string_view s) {
  while (!s.empty() && (s.front() == ' ' || s.front() == '\t')) s.remove_prefix(1);
  while (!s.empty() && (s.back() == ' ' || s.back() == '\t')) s.remove_suffix(1);
  return s;
}

std::string_view Request::header(std::string_view name) const {
  for (const Field& f : headers) {
    if (iequals(f.name, name)) return f.value;
  }
  return {};
}

bool Request::has_header(std::string_view name) const {
  for (const Field& f : headers) {
    if (iequals(f.name, name)) return true;
  }
  return false;
}

std::optional<std::string_view> Request::query_value(std::string_view name) const {
  for (const Field& f : query) {
    if (f.name == name) return f.value;
  }
  return std::nullopt;
}

std::string_view Request::param(std::string_view name) const {
  for (const Field& f : params) {
    if (f.name == name) return f.value;
  }
  return {};
}

bool Request::header_has_token(std::string_view name, std::string_view token) const {
  for (const Field& f : headers) {
    if (iequals(f.name, name) && any_item(f.value, [&](std::string_view item) {
          return iequals(trim(item.substr(0, item.find(';'))), token);
        })) {
      return true;
    }
  }
  return false;
}

bool Request::accepts(std::string_view media_type) const {
  if (!has_header("accept")) return true;
  const std::string_view type = media_type.substr(0, media_type.find('/'));
  // The most specific match decides, so that "application/json;q=0, */*" refuses JSON.
  int best = -1;
  bool accepted = false;
  for (const Field& f : headers) {
    if (!iequals(f.name, "accept")) continue;
    any_item(f.value, [&](std::string_view item) {
      const size_t semicolon = item.find(';');
      const std::string_view range = trim(item.substr(0, semicolon));
      const size_t slash = range.find('/');
      int rank = -1;
      if (iequals(range, media_type)) {
        rank = 2;
      } else if (slash != std::string_view::npos && range.substr(slash) == "/*") {
        rank = range == "*/*" ? 0 : iequals(range.substr(0, slash), type) ? 1 : -1;
      }
      if (rank > best) {
        best = rank;
        accepted = semicolon == std::string_view::npos || !refused_by_quality(item.substr(semicolon));
      }
      return false;
    });
  }
  return accepted;
}

const std::string& Request::trace_id() const {
  if (!trace_id_.empty()) return trace_id_;
  // W3C trace context: version "-" 32 digits "-" ...
  const std::string_view parent = header("traceparent");
  if (parent.size() >= 55 && parent[2] == '-' && parent[35] == '-' &&
      parent.substr(3, 32).find_first_not_of("0123456789abcdef") == std::string_view::npos) {
    trace_id_ = parent.substr(3, 32);
  } else {
    trace_id_ = random_hex128();
  }
  return trace_id_;
}

void Request::clear() {
  head_.clear();
  ends_.clear();
  segments.clear();
  query.clear();
  headers.clear();
  params.clear();
  // A body of many megabytes is freed; the usual small one is kept for the next request.
  if (body.capacity() > 65536) std::string().swap(body);
  body.clear();
  method = Method::other;
  method_text = target = raw_path = {};
  caller = {};
  key_digest.clear();
  trace_id_.clear();
  http10 = false;
}

FileBody FileBody::of(int fd) {
  if (fd < 0 && (errno == EMFILE || errno == ENFILE))
    throw Error("overloaded", "no more files can be opened at the moment");
  if (fd < 0) throw Error("not_found", "no such file (" + std::string(std::strerror(errno)) + ")");
  FileBody body;
  body.fd_ = std::shared_ptr<int>(new int(fd), [](int* f) {
    ::close(*f);
    delete f;
  });
  struct stat info {};
  if (::fstat(fd, &info) != 0 || !S_ISREG(info.st_mode)) throw Error("not_found", "not a regular file");
  body.size_ = static_cast<uint64_t>(info.st_size);
  Hasher h;
  h.integer(info.st_ino);
  h.integer(body.size_);
  h.integer(static_cast<uint64_t>(info.st_mtim.tv_sec));
  h.integer(static_cast<uint64_t>(info.st_mtim.tv_nsec));
  body.etag_ = '"' + hex64(h.value()) + '"';
  return body;
}

Response Response::text(std::string body, std::string content_type, int status) {
  Response r(status);
  r.body = std::move(body);
  r.content_type = std::move(content_type);
  return r;
}

Response Response::json(std::string body, int status) {
  return text(std::move(body), "application/json", status);
}

Response Response::shared(SharedBuffer body, std::string content_type, std::string etag) {
  Response r;
  r.body = std::move(body);
  r.content_type = std::move(content_type);
  r.etag = std::move(etag);
  return r;
}

Response Response::file(int fd, std::string content_type) {
  FileBody f = FileBody::of(fd);
  Response r;
  r.etag = f.etag();
  r.content_type = std::move(content_type);
  r.body = std::move(f);
  return r;
}

Response& Response::header(std::string_view name, std::string_view value) {
  header_block_.reserve(header_block_.size() + name.size() + value.size() + 4);
  header_block_ += name;
  header_block_ += ": ";
  for (const char c : value) {
    if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7F) header_block_ += c;
  }
  header_block_ += "\r\n";
  return *this;
}

uint64_t Response::body_size() const {
  if (const auto* f = std::get_if<FileBody>(&body)) return f->size();
  return body_bytes().size();
}

std::string_view Response::body_bytes() const {
  if (const auto* s = std::get_if<std::string>(&body)) return *s;
  if (const auto* s = std::get_if<SharedBuffer>(&body))
    return *s ? std::string_view(**s) : std::string_view();
  return {};
}

}  // namespace truestep::net
