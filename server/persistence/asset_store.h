// Assets shared by scenes - JSON values, mesh and motion files - kept under the SHA-256 of their bytes. A
// scene says {"asset": "<sha256>"} in place of the value (engine/scene/file_references.h); the server
// substitutes the value, so that a session, its snapshots and its bundle hold everything they need and an
// asset may be removed at any time.
#pragma once
#include <boost/json.hpp>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/net/http/message.h"
#include "server/persistence/place.h"
#include "server/sessions/memory_budget.h"

namespace truestep {

class AssetStore {
 public:
  /// `most_bytes` bounds all assets together. Without a data folder (nowhere) there are none.
  AssetStore(const Place& data_folder, double most_bytes);

  enum class Kind : uint8_t { json, file };
  struct Asset {
    Kind kind;
    std::string bytes;
  };

  /// Keeps the bytes; false: already there. Error "invalid" when their hash differs, "bad_json" or
  /// "bad_request" when no scene could use them, "quota_exceeded", "disk_full" or "folder_io".
  bool put(const std::string& sha256, std::string_view bytes, Kind kind, const net::Caller& owner);
  /// Error "not_found".
  Asset get(const std::string& sha256) const;
  /// Ends the caller's claim; the asset goes with the last one. Error "not_found", or "forbidden" when others
  /// put it there.
  void remove(const std::string& sha256, const net::Caller& caller);

  /// Replaces the document's references by the assets' values, for which memory is leased. Error
  /// "scene_invalid" with a pointer to every reference that leads nowhere, "too_large" when the result is.
  MemoryBudget::Lease resolve(boost::json::value& document, MemoryBudget& memory) const;

 private:
  Place owners_place(const std::string& sha256) const;
  /// Names of the keys that put it there, one a line in a file beside it; none for an asset of an older
  /// server.
  std::vector<std::string> owners(const std::string& sha256) const;
  void set_owners(const std::string& sha256, const std::vector<std::string>& names);
  Place place_of(const std::string& sha256, Kind kind) const;
  Place folder_;
  double most_bytes_;
  mutable std::mutex mutex_;
};

}  // namespace truestep
