// Assets shared by scenes - JSON values, mesh and motion files - kept under the SHA-256 of their bytes. A
// scene says {"asset": "<sha256>"} in place of the value (engine/scene/file_references.h); the server
// substitutes the value, so that a session, its snapshots and its bundle hold everything they need and an
// asset may be removed at any time.
#pragma once
#include <boost/json.hpp>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>

namespace truestep {

class AssetStore {
 public:
  /// `most_bytes` bounds all assets together. Without a data folder (empty) there are none.
  AssetStore(const std::string& data_dir, double most_bytes);

  enum class Kind : uint8_t { json, file };
  struct Asset {
    Kind kind;
    std::string bytes;
  };

  /// Keeps the bytes; false: already there. Error "invalid" when their hash differs, "bad_json" or
  /// "bad_request" when no scene could use them, "quota_exceeded", "disk_full" or "folder_io".
  bool put(const std::string& sha256, std::string_view bytes, Kind kind);
  /// Error "not_found".
  Asset get(const std::string& sha256) const;
  /// Error "not_found".
  void remove(const std::string& sha256);

  /// Replaces the document's references by the assets' values. Error "scene_invalid" with a pointer to every
  /// reference that leads nowhere, "too_large" when the result is.
  void resolve(boost::json::value& document) const;

 private:
  std::filesystem::path path_of(const std::string& sha256, Kind kind) const;
  std::filesystem::path folder_;
  double most_bytes_;
  mutable std::mutex mutex_;
};

}  // namespace truestep
