// What scenes share - JSON values, mesh and motion files - kept under the SHA-256 of its bytes. A scene says
// {"asset": "<sha256>"} where the value would stand (engine/scene/file_references.h); the server puts the
// value there, so that a session, its snapshots and its bundle hold all they need and an asset may go at any
// time.
#pragma once
#include <boost/json.hpp>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>

namespace truestep {

class AssetStore {
 public:
  /// `most_bytes` of all assets. Without a data folder (empty) there are none.
  AssetStore(const std::string& data_dir, double most_bytes);

  enum class Kind : uint8_t { json, file };
  struct Asset {
    Kind kind;
    std::string bytes;
  };

  /// Keeps bytes; false: they were there. Error "invalid" when their hash is another, "bad_json" or
  /// "bad_request" for what no scene could use, "quota_exceeded", "disk_full", "folder_io", or "not_found"
  /// where nothing can be kept.
  bool put(const std::string& sha256, std::string_view bytes, Kind kind);
  /// Error "not_found".
  Asset get(const std::string& sha256) const;
  /// Error "not_found".
  void remove(const std::string& sha256);

  /// Puts the assets that the document refers to in their places. Error "scene_invalid" with a pointer to
  /// every reference that leads nowhere, "too_large" when all of it together is.
  void resolve(boost::json::value& document) const;

 private:
  std::filesystem::path path_of(const std::string& sha256, Kind kind) const;
  std::filesystem::path folder_;
  double most_bytes_;
  mutable std::mutex mutex_;
};

}  // namespace truestep
