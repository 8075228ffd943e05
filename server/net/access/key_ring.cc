// The text of a key file, checked as a whole: a line that could be the rest of another one is an error, never
// a key that nobody gave out.
#include <algorithm>
#include <sstream>

#include "engine/base/errors.h"
#include "server/net/access/digest.h"
#include "server/net/access/keys.h"
#include "server/net/access/whole_file.h"

namespace truestep::net {

namespace {

constexpr std::string_view kDigest = "sha256:";
constexpr size_t kDigestDigits = 64;
constexpr size_t kMostBytes = 1 << 20;

bool is_hex(std::string_view s) {
  return std::ranges::all_of(
      s, [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F'); });
}

// "md5:5f4d..." is a digest of a kind that nobody could log in with, not a key of that text.
bool is_other_digest(std::string_view key) {
  const size_t colon = key.find(':');
  return colon != std::string_view::npos && key.size() - colon > 32 && is_hex(key.substr(colon + 1));
}

// The key's digest in lower case; what is wrong with the key is put into `fault`.
std::string digest_of(const std::string& key, std::string& fault) {
  if (key.starts_with(kDigest)) {
    std::string digest = key.substr(kDigest.size());
    if (digest.size() != kDigestDigits || !is_hex(digest)) {
      fault = "\"sha256:\" is followed by 64 hexadecimal digits, not by " + std::to_string(digest.size()) +
              (is_hex(digest) ? "" : " characters of another kind");
    }
    std::ranges::transform(digest, digest.begin(), [](char c) { return c >= 'A' && c <= 'F' ? c + 32 : c; });
    return digest;
  }
  if (key.size() < KeyRing::kShortestKey) {
    fault = "a key has at least 20 characters, or is \"sha256:\" and 64 hexadecimal digits; this one has " +
            std::to_string(key.size());
  } else if (!std::ranges::all_of(key, [](char c) { return c > ' ' && c <= '~'; })) {
    fault = "a key consists of visible ASCII characters";
  } else if (is_other_digest(key)) {
    fault = "the only digests are \"sha256:\" and 64 hexadecimal digits";
  }
  return sha256_hex(key);
}

}  // namespace

KeyRing KeyRing::load(const std::string& path) {
  return read(read_whole_file(path, "the key file " + path, kMostBytes), "the key file " + path);
}

KeyRing KeyRing::read(std::string_view text, const std::string& what) {
  KeyRing ring;
  for (int number = 1; !text.empty(); ++number) {
    const size_t end = text.find('\n');
    const std::string line(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    const auto fail = [&](const std::string& why) {
      throw Error("bad_request", "line " + std::to_string(number) + " of " + what + ": " + why);
    };
    if (line.find('\0') != std::string::npos) fail("it contains a zero byte");
    std::istringstream words(line.substr(0, line.find('#')));
    std::string name, key, scope, more, fault;
    if (!(words >> name)) continue;
    if (!(words >> key)) std::swap(name, key);
    words >> scope;
    if ((!scope.empty() && scope != "admin") || words >> more)
      fail("it is not NAME KEY, NAME KEY admin or KEY");
    std::string digest = digest_of(key, fault);
    if (!fault.empty()) fail(fault);
    // The rest of a file that is being written may be missing: of a digest that would show.
    if (end == std::string_view::npos && !key.starts_with(kDigest))
      fail("the file ends within it; a key's line ends with a newline");
    if (ring.find(digest)) fail("this key stands further up, too");
    if (name.empty()) name = digest.substr(0, 12);
    ring.keys_.push_back(
        {{std::move(name), scope.empty() ? Caller::Scope::own : Caller::Scope::all}, std::move(digest)});
  }
  if (ring.keys_.empty()) throw Error("bad_request", what + " holds no key");
  return ring;
}

const Caller* KeyRing::find(std::string_view digest) const {
  const Caller* found = nullptr;
  for (const Key& k : keys_) {
    if (equal_constant_time(k.digest, digest)) found = &k.caller;
  }
  return found;
}

}  // namespace truestep::net
