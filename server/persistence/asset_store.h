// JSON values that scenes share - vertices of a mesh, a table of heights - kept under the SHA-256 of their
// text. A scene says {"asset": "<sha256>"} where the value would stand; the server puts the value there, so
// that a session, its snapshots and its bundle hold all they need and an asset may go at any time.
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

  /// Keeps a text; false: it was there. Error "bad_request" when its hash is another, "quota_exceeded",
  /// "disk_full", "folder_io", or "not_found" where nothing can be kept.
  bool put(const std::string& sha256, std::string_view text);
  /// The text. Error "not_found".
  std::string get(const std::string& sha256) const;
  /// Error "not_found".
  void remove(const std::string& sha256);

  /// Puts the assets that the document refers to in their places. Error "scene_invalid" with a pointer to
  /// every reference that leads nowhere, "too_large" when all of it together is.
  void resolve(boost::json::value& document) const;

 private:
  std::filesystem::path path_of(const std::string& sha256) const;
  std::filesystem::path folder_;
  double most_bytes_;
  mutable std::mutex mutex_;
};

}  // namespace truestep
