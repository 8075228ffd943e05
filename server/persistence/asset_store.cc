#include "server/persistence/asset_store.h"

#include <algorithm>
#include <cerrno>

#include "engine/base/errors.h"
#include "engine/base/text/utf8.h"
#include "engine/scene/file_references.h"
#include "engine/scene/file_value.h"
#include "engine/scene/json/json.h"
#include "server/net/access/digest.h"
#include "server/persistence/files.h"

namespace truestep {

namespace json = boost::json;

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

AssetStore::AssetStore(const Place& data_folder, double most_bytes)
    : folder_(data_folder ? data_folder / "assets" : Place()), most_bytes_(most_bytes) {}

Place AssetStore::place_of(const std::string& sha256, Kind kind) const {
  if (!folder_ || !is_sha256(sha256)) throw no_asset();
  return folder_ / (sha256 + (kind == Kind::json ? ".json" : ".bin"));
}

Place AssetStore::owners_place(const std::string& sha256) const {
  return folder_ / (sha256 + ".owners");
}

std::vector<std::string> AssetStore::owners(const std::string& sha256) const {
  constexpr size_t kMostOwners = size_t{1} << 20;  // bytes
  std::vector<std::string> names;
  if (!owners_place(sha256).is_surely_regular()) return names;
  const std::string text(text_of(read_file(owners_place(sha256), kMostOwners)));
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find('\n', at), text.size());
    names.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return names;
}

void AssetStore::set_owners(const std::string& sha256, const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += name + '\n';
  write_file(owners_place(sha256), bytes_of(text), Durability::process);
}

bool AssetStore::put(const std::string& sha256, std::string_view bytes, Kind kind, const net::Caller& owner) {
  if (!folder_) throw Error("folder_io", "this server's data folder could not be used when it started");
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
  const Place place = place_of(sha256, kind);
  const std::lock_guard lock(mutex_);
  if (place.is_surely_regular()) {
    std::vector<std::string> names = owners(sha256);
    // One of an older server belongs to everybody, as it did.
    if (!names.empty() && std::find(names.begin(), names.end(), owner.name) == names.end()) {
      names.push_back(owner.name);
      set_owners(sha256, names);
    }
    return false;
  }
  folder_.make_folder();
  if (folder_bytes(folder_) + static_cast<double>(bytes.size()) > most_bytes_)
    throw Error("quota_exceeded", "this server has no room for more assets: DELETE /v1/assets/{sha256} some");
  set_owners(sha256, {owner.name});
  write_file(place, bytes_of(bytes), Durability::process);
  return true;
}

AssetStore::Asset AssetStore::get(const std::string& sha256) const {
  const std::lock_guard lock(mutex_);
  for (const Kind kind : {Kind::json, Kind::file}) {
    const Place place = place_of(sha256, kind);
    if (place.is_surely_regular()) return {kind, std::string(text_of(read_file(place, kMostBytes)))};
  }
  throw no_asset();
}

void AssetStore::remove(const std::string& sha256, const net::Caller& caller) {
  const std::lock_guard lock(mutex_);
  bool any = false;
  for (const Kind kind : {Kind::json, Kind::file}) any = any || place_of(sha256, kind).is_surely_regular();
  if (!any) throw no_asset();
  if (std::vector<std::string> names = owners(sha256); !names.empty()) {
    const bool own = std::erase(names, caller.name) > 0;
    if (!own && caller.scope == net::Caller::Scope::own)
      throw Error("forbidden", "this asset was put here with another key");
    if (own && !names.empty()) return set_owners(sha256, names);
  }
  owners_place(sha256).remove();
  any = false;
  for (const Kind kind : {Kind::json, Kind::file}) {
    const int code = place_of(sha256, kind).remove();
    any = any || code == 0;
    if (code && code != ENOENT) throw_file_error("remove the asset", code);
  }
  if (!any) throw no_asset();
}

MemoryBudget::Lease AssetStore::resolve(json::value& document, MemoryBudget& memory) const {
  // As for a request's body.
  constexpr double kMemoryPerByte = 3.5;
  auto lease = memory.lease(0, "the assets of this scene");
  resolve_files(document, "asset", [&](const std::string& hash) {
    std::string bytes = get(hash).bytes;
    lease.require(lease.bytes() + kMemoryPerByte * static_cast<double>(bytes.size()),
                  "the assets of this scene");
    return bytes;
  });
  resolve_files(document, "path", [](const std::string&) -> std::string {
    throw Error("not_found",
                "paths work only in scene files of the command line: PUT the file to /v1/assets/{sha256} and "
                "give {\"asset\": sha256}");
  });
  return lease;
}

}  // namespace truestep
