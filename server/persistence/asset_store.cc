#include "server/persistence/asset_store.h"

#include <algorithm>

#include "engine/base/errors.h"
#include "engine/base/text/utf8.h"
#include "engine/scene/file_references.h"
#include "engine/scene/file_value.h"
#include "engine/scene/json/json.h"
#include "server/net/access/digest.h"
#include "server/persistence/files.h"

namespace truestep {

namespace json = boost::json;
namespace fs = std::filesystem;

namespace {

constexpr size_t kMostBytes = size_t{64} << 20;  // of one asset

Error no_asset() {
  return {"not_found", "there is no such asset"};
}

// Bytes that are not JSON are a file that scenes can use, or a text.
void require_readable(std::string_view bytes) {
  if (bytes.empty()) throw Error("bad_request", "an asset must have at least one byte");
  try {
    file_value(bytes, FileUse::automatic, 1);
  } catch (const FileFault& fault) {
    if (valid_utf8(bytes) && !is_mesh_file(bytes)) return;
    throw Error("bad_request", std::string("the asset cannot be read: ") + fault.what());
  } catch (const Error& fault) {
    if (fault.code() != "bad_json") throw;
  }
}

bool is_sha256(std::string_view s) {
  return s.size() == 64 && std::all_of(s.begin(), s.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
         });
}

}  // namespace

AssetStore::AssetStore(const std::string& data_dir, double most_bytes)
    : folder_(data_dir.empty() ? fs::path() : fs::path(data_dir) / "assets"), most_bytes_(most_bytes) {}

fs::path AssetStore::path_of(const std::string& sha256, Kind kind) const {
  if (folder_.empty() || !is_sha256(sha256)) throw no_asset();
  return folder_ / (sha256 + (kind == Kind::json ? ".json" : ".bin"));
}

bool AssetStore::put(const std::string& sha256, std::string_view bytes, Kind kind) {
  if (folder_.empty())
    throw Error("folder_io", "this server's data folder could not be used when it started");
  const std::string actual = net::sha256_hex(bytes);
  if (actual != sha256) {
    throw Error("invalid", "the body has another SHA-256",
                {{"/sha256", "mismatch", "the body has another SHA-256", '"' + sha256.substr(0, 64) + '"',
                  actual, "", ""}});
  }
  if (kind == Kind::json) {
    parse_json(bytes);
  } else {
    require_readable(bytes);
  }
  const fs::path path = path_of(sha256, kind);
  const std::lock_guard lock(mutex_);
  if (is_regular(path)) return false;
  std::error_code failed;
  fs::create_directories(folder_, failed);
  if (failed) throw_file_error("make the folder of assets", failed.value());
  if (folder_bytes(folder_) + static_cast<double>(bytes.size()) > most_bytes_)
    throw Error("quota_exceeded", "this server has no room for more assets: DELETE /v1/assets/{sha256} some");
  write_file(path, bytes_of(bytes), Durability::process);
  return true;
}

AssetStore::Asset AssetStore::get(const std::string& sha256) const {
  const std::lock_guard lock(mutex_);
  for (const Kind kind : {Kind::json, Kind::file}) {
    const fs::path path = path_of(sha256, kind);
    if (is_regular(path)) return {kind, std::string(text_of(read_file(path, kMostBytes)))};
  }
  throw no_asset();
}

void AssetStore::remove(const std::string& sha256) {
  const std::lock_guard lock(mutex_);
  bool any = false;
  for (const Kind kind : {Kind::json, Kind::file}) {
    std::error_code failed;
    any = fs::remove(path_of(sha256, kind), failed) || any;
    if (failed) throw_file_error("remove the asset", failed.value());
  }
  if (!any) throw no_asset();
}

void AssetStore::resolve(json::value& document) const {
  resolve_files(document, "asset", [this](const std::string& hash) { return get(hash).bytes; });
  resolve_files(document, "path", [](const std::string&) -> std::string {
    throw Error("not_found",
                "paths work only in scene files of the command line: PUT the file to /v1/assets/{sha256} and "
                "give {\"asset\": sha256}");
  });
}

}  // namespace truestep
