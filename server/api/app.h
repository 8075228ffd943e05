// The application behind the routes: sessions, threads, counters. One object, handed to every route.
#pragma once
#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "engine/sinks/recording/recording_thread.h"
#include "server/net/http/router.h"
#include "server/net/options.h"
#include "server/net/server.h"
#include "server/operations/operation_store.h"
#include "server/persistence/asset_store.h"
#include "server/persistence/recording_catalogue.h"
#include "server/persistence/sessions/session_archive.h"
#include "server/sessions/idempotency.h"
#include "server/sessions/runner.h"
#include "server/sessions/store.h"
#include "server/stream/stream.h"

namespace truestep {

struct AppOptions {
  net::Options net;
  StoreLimits limits;
  int workers = 2;  ///< threads that advance sessions
  /// How long a session keeps playing after its last viewer has left; empty: for ever.
  std::optional<std::chrono::milliseconds> unwatched_grace = std::chrono::seconds(10);
  std::string data_dir;  ///< where recordings and sessions are kept; empty: nothing outlives the process
  std::optional<ArchiveLimits> keep_sessions;  ///< empty: sessions end with the process
  RecordingLimits recordings;
  double max_asset_bytes = 2e9;  ///< of all assets on disk
};

/// The data folder, nowhere without one or when it cannot be opened.
Place open_data(const AppOptions& options);
/// The sessions kept in the data folder; null when nothing is kept.
std::unique_ptr<SessionArchive> open_archive(const AppOptions& options, const Place& data,
                                             MemoryBudget& memory);

class FolderLock;

struct App {
  /// Error "folder_io" when the data folder is not there any more.
  void require_folder() const;

  explicit App(AppOptions o)
      : options(std::move(o)),
        memory(options.limits.max_memory_bytes),
        data(open_data(options)),
        archive(open_archive(options, data, memory)),
        recordings(data, options.recordings),
        assets(data, options.max_asset_bytes),
        store(options.limits, memory, archive.get()),
        runner(options.workers, options.unwatched_grace) {}

  const AppOptions options;
  std::shared_ptr<RecordingThread> recording_thread = std::make_shared<RecordingThread>();
  MemoryBudget memory;
  const Place data;  ///< the data folder
  const std::unique_ptr<SessionArchive> archive;
  RecordingCatalogue recordings;
  AssetStore assets;
  SessionStore store;
  IdempotencyKeys idempotency;
  StreamStats stream_stats;
  OperationStore operations{OperationLimits{.per_run = options.limits.per_session}, options.workers, memory};
  std::atomic<bool> repairing{false};   ///< recordings of an earlier run are being repaired; no new ones
                                        ///< meanwhile
  Runner runner;                        ///< last, so that its threads end before anything they use
  const net::Server* server = nullptr;  ///< for the metrics page; set before the server starts
  const FolderLock* folder = nullptr;   ///< on the data folder; likewise
};

/// The complete table of routes. `app` must outlive the router.
net::Router make_router(App& app);

// Parts of the table, one file each.
void add_session_routes(net::Router& router, App& app);
void add_playback_routes(net::Router& router, App& app);
void add_snapshot_routes(net::Router& router, App& app);
void add_frame_routes(net::Router& router, App& app);
void add_motion_routes(net::Router& router, App& app);
void add_query_routes(net::Router& router, App& app);
void add_asset_routes(net::Router& router, App& app);
void add_catalogue_routes(net::Router& router, App& app);
void add_thumbnail_routes(net::Router& router, App& app);
void add_operation_routes(net::Router& router, App& app);
void add_service_routes(net::Router& router, App& app);

}  // namespace truestep
