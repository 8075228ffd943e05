#include "server/persistence/asset_store.h"

#include <algorithm>

#include "engine/base/errors.h"
#include "engine/base/json_pointer.h"
#include "engine/scene/json.h"
#include "server/net/digest.h"
#include "server/persistence/files.h"

namespace truestep {

namespace json = boost::json;
namespace fs = std::filesystem;

namespace {

constexpr size_t kMostText = size_t{64} << 20;       // bytes of one asset
constexpr size_t kMostResolved = size_t{128} << 20;  // bytes of text that a document may come to by them

Error no_asset() {
  return {"not_found", "there is no such asset"};
}

bool is_sha256(std::string_view s) {
  return s.size() == 64 && std::all_of(s.begin(), s.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
         });
}

// The hash of {"asset": hash}; nothing for any other value.
const json::string* reference(const json::value& v) {
  const json::object* o = v.if_object();
  if (!o || o->size() != 1 || o->begin()->key() != "asset") return nullptr;
  return o->begin()->value().if_string();
}

/// One document's references on the way to their values.
struct Resolving {
  const AssetStore& store;
  std::vector<Issue> issues = {};
  size_t bytes = 0;

  void value(json::value& v, const std::string& pointer) {
    if (const json::string* hash = reference(v)) {
      replace(v, std::string(*hash), pointer);
    } else if (json::object* o = v.if_object()) {
      for (auto& [key, member] : *o) {
        std::string at = pointer;
        append_pointer(at, {key.data(), key.size()});
        value(member, at);
      }
    } else if (json::array* a = v.if_array()) {
      // Lists of numbers are long and hold no references.
      for (size_t i = 0; i < a->size() && ((*a)[i].is_object() || (*a)[i].is_array()); ++i)
        value((*a)[i], pointer + "/" + std::to_string(i));
    }
  }

  void replace(json::value& v, const std::string& hash, const std::string& pointer) {
    try {
      const std::string text = store.get(hash);
      bytes += text.size();
      if (bytes > kMostResolved)
        throw Error("too_large", "the scene's assets are larger than 128 MiB together");
      v = parse_json(text);
    } catch (const Error& e) {
      if (e.code() != "not_found") throw;
      issues.push_back({pointer + "/asset", "unknown_asset", "there is no such asset",
                        '"' + hash.substr(0, 64) + '"', "a hash that PUT /v1/assets/{sha256} was given", "",
                        ""});
    }
  }
};

}  // namespace

AssetStore::AssetStore(const std::string& data_dir, double most_bytes)
    : folder_(data_dir.empty() ? fs::path() : fs::path(data_dir) / "assets"), most_bytes_(most_bytes) {}

fs::path AssetStore::path_of(const std::string& sha256) const {
  if (folder_.empty() || !is_sha256(sha256)) throw no_asset();
  return folder_ / (sha256 + ".json");
}

bool AssetStore::put(const std::string& sha256, std::string_view text) {
  if (folder_.empty()) throw Error("not_found", "this server has no data folder to keep assets in");
  const std::string actual = net::sha256_hex(text);
  if (actual != sha256) {
    throw Error("invalid", "the body has another SHA-256",
                {{"/sha256", "mismatch", "the body has another SHA-256", '"' + sha256.substr(0, 64) + '"',
                  actual, "", ""}});
  }
  parse_json(text);
  const fs::path path = path_of(sha256);
  const std::lock_guard lock(mutex_);
  if (fs::exists(path)) return false;
  std::error_code failed;
  fs::create_directories(folder_, failed);
  if (failed) throw Error("folder_io", "the assets' folder cannot be made: " + failed.message());
  if (folder_bytes(folder_) + static_cast<double>(text.size()) > most_bytes_)
    throw Error("quota_exceeded", "this server keeps no more assets: DELETE /v1/assets/{sha256} some");
  write_file(path, bytes_of(text), Durability::process);
  return true;
}

std::string AssetStore::get(const std::string& sha256) const {
  const fs::path path = path_of(sha256);
  const std::lock_guard lock(mutex_);
  if (!fs::exists(path)) throw no_asset();
  return std::string(text_of(read_file(path, kMostText)));
}

void AssetStore::remove(const std::string& sha256) {
  const fs::path path = path_of(sha256);
  const std::lock_guard lock(mutex_);
  std::error_code failed;
  if (!fs::remove(path, failed)) throw no_asset();
}

void AssetStore::resolve(json::value& document) const {
  Resolving all{*this};
  all.value(document, "");
  if (!all.issues.empty())
    throw Error("scene_invalid", "the scene refers to assets that are not there", std::move(all.issues));
}

}  // namespace truestep
