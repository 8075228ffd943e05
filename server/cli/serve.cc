#include "server/cli/serve.h"

#include <malloc.h>
#include <signal.h>

#include <condition_variable>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <mutex>
#include <new>
#include <optional>
#include <thread>

#include "engine/base/log.h"
#include "engine/base/version.h"
#include "server/api/app.h"
#include "server/api/recordings.h"
#include "server/api/restoring.h"
#include "server/cli/duration.h"
#include "server/cli/exit_codes.h"
#include "server/data/folder_lock.h"
#include "server/net/access/address.h"
#include "server/net/health.h"
#include "server/net/termination.h"

namespace truestep {

namespace {

struct ServeOptions {
  std::string host = "127.0.0.1", data_dir, key_file, log_level = "info";
  uint16_t port = 8080;
  int threads = 0;
  double max_memory_mb = 8000;
  size_t max_message_kib = 1024;
  int64_t max_sessions = 10000, session_ttl = 3600;
  std::vector<std::string> hosts, origins;
  std::string keep_sessions = "7d", keep_recordings = "forever", pause_unwatched = "10s";
  double max_kept_mb = 10000, max_recordings_mb = 0;
  bool insecure = false;
};

AppOptions app_options(const ServeOptions& o) {
  if (!net::is_loopback(o.host) && o.key_file.empty() && !o.insecure) {
    throw Error(
        "bad_request",
        "binding " + o.host +
            " is reachable by other machines: give --api-key-file, or --insecure if that is intended");
  }
  AppOptions a;
  a.net.host = o.host;
  a.net.port = o.port;
  a.net.api_key_file = o.key_file;
  a.net.allowed_hosts = o.hosts;
  a.net.allowed_origins = o.origins;
  a.net.websocket.max_message = o.max_message_kib << 10;
  a.workers = o.threads > 0 ? o.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  a.limits.threads_per_session = a.workers;
  a.limits.max_memory_bytes = o.max_memory_mb * 1e6;
  a.limits.per_session.memory_bytes = std::min(a.limits.per_session.memory_bytes, a.limits.max_memory_bytes);
  a.limits.max_sessions = static_cast<size_t>(o.max_sessions);
  a.limits.idle_ttl = std::chrono::seconds(o.session_ttl);
  a.unwatched_grace = read_duration("--pause-unwatched", o.pause_unwatched);
  a.data_dir = o.data_dir;
  if (const auto keep = read_duration("--keep-sessions", o.keep_sessions); keep && keep->count() > 0)
    a.keep_sessions = ArchiveLimits{*keep, o.max_kept_mb * 1e6};
  else if (!keep)
    a.keep_sessions = ArchiveLimits{std::chrono::hours(24 * 365 * 100), o.max_kept_mb * 1e6};
  a.recordings = {o.max_recordings_mb * 1e6, read_duration("--keep-recordings", o.keep_recordings)};
  return a;
}

std::string default_data_dir() {
  const char* xdg = std::getenv("XDG_DATA_HOME");
  const char* home = std::getenv("HOME");
  if (xdg && *xdg) return std::string(xdg) + "/truestep";
  return home && *home ? std::string(home) + "/.local/share/truestep" : "/tmp/truestep";
}

std::chrono::seconds pause_between_sweeps(const AppOptions& options) {
  auto pause = std::min(std::chrono::seconds(30), options.limits.idle_ttl);
  if (options.keep_sessions) pause = std::min(pause, options.keep_sessions->keep);
  return std::max(pause, std::chrono::seconds(1));
}

// Unloads and removes what nobody uses.
void sweep_all(App& app) {
  for (const EntryPtr& entry : app.store.expire()) unload(app, entry);
  if (app.archive) {
    for (const std::string& id : app.archive->sweep()) log_info("session {} is no longer kept", id);
  }
  app.recordings.sweep();
}

void sweep(App& app) {
  try {
    sweep_all(app);
  } catch (const std::bad_alloc&) {
    // The rest is for the next sweep, when there may be memory again.
    log_warn("no memory to unload what nobody uses");
  }
  // Returns memory freed by large sessions and studies to the operating system.
  malloc_trim(0);
}

/// Open streams hold their sessions and the sessions hold the streams; this breaks the cycle.
void let_sinks_go(App& app) {
  for (const EntryPtr& entry : app.store.all()) {
    const std::lock_guard lock(entry->mutex);
    entry->session.remove_sinks();
  }
}

/// Ends the process when work that cannot be interrupted exceeds the time allowed for shutdown. By then
/// recordings are complete and peers have been told. Its thread exists from the start: at the end there may
/// be no memory for one.
class LastResort {
 public:
  LastResort() : thread_([this] { watch(); }) {}
  ~LastResort() {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    changed_.notify_one();
    thread_.join();
  }
  LastResort(const LastResort&) = delete;
  LastResort& operator=(const LastResort&) = delete;

  void begin(std::chrono::milliseconds patience) {
    {
      const std::lock_guard lock(mutex_);
      end_ = std::chrono::steady_clock::now() + patience;
    }
    changed_.notify_one();
  }

 private:
  void watch() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return ended_ || end_; });
    if (ended_ || changed_.wait_until(lock, *end_, [this] { return ended_; })) return;
    log_warn("work still running is abandoned");
    std::_Exit(kExitOk);
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = false;
  std::optional<std::chrono::steady_clock::time_point> end_;
  std::thread thread_;
};

/// In this order: stop accepting, tell the streams, stop the work, complete the recordings, end the network
/// threads, then the threads that hand them answers. Nothing is destroyed while a thread may use it.
void shut_down(net::Server& server, App& app, LastResort& last_resort) {
  const auto begun = std::chrono::steady_clock::now();
  for (const EntryPtr& entry : app.store.all()) {
    const std::lock_guard lock(entry->mutex);
    entry->session.say_bye("draining", "the service is shutting down");
  }
  server.drain();
  app.runner.cancel_all(app.store.all());
  app.operations.cancel_all();
  app.store.cancel_creations();
  close_recordings(app);
  server.stop(std::chrono::milliseconds(1500));
  const auto taken =
      std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - begun);
  last_resort.begin(std::max(std::chrono::milliseconds(4000) - taken, std::chrono::milliseconds(500)));
  app.operations.stop();
  app.runner.join();
  save_sessions(app);
  let_sinks_go(app);
}

// The folder becomes "" when nothing can be written.
FolderLock lock_data_folder(std::string& folder) {
  try {
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (failed) throw Error("folder_unusable", folder + " cannot be created: " + failed.message());
    return FolderLock(folder);
  } catch (const Error& e) {
    if (e.code() != "folder_unusable") throw;
    log_warn("no recordings, and no session outlives the server: {}", e.what());
    folder.clear();
    return {};
  }
}

int serve(const ServeOptions& options) {
  start_log(options.log_level);
  AppOptions settings = app_options(options);
  if (settings.data_dir.empty()) settings.data_dir = default_data_dir();
  // Before reading anything in the folder: recordings of another running server must not be repaired.
  const FolderLock folder = lock_data_folder(settings.data_dir);
  // Declared first and so destroyed last: the server's connections use it.
  App app(settings);
  net::Server server(settings.net, make_router(app));
  app.server = &server;
  app.folder = &folder;
  // Large blocks are mapped individually, so that freeing one returns it to the system, whatever surrounds
  // it.
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  // A closed peer or log pipe shows up as an error of write().
  ::signal(SIGPIPE, SIG_IGN);
  net::Termination termination;
  LastResort last_resort;
  app.repairing = true;
  app.recordings.read_folder();
  server.start();
  std::cout << "Truestep " << version() << " listening on " << server.url() << std::endl;
  if (app.archive) {
    for (const std::string& what : app.archive->damage()) log_error("{}", what);
  }
  app.recordings.repair(*app.recording_thread);
  app.repairing = false;

  termination.wait(pause_between_sweeps(app.options), [&app] { sweep(app); });
  log_info("shutting down");
  shut_down(server, app, last_resort);
  return kExitOk;
}

int health(const std::string& url) {
  const bool good = net::is_healthy(url);
  std::cout << (good ? "ok" : "no answer from " + url) << '\n';
  return good ? kExitOk : kExitServer;
}

}  // namespace

void add_serve_command(Arguments app, int& exit_code) {
  auto o = std::make_shared<ServeOptions>();
  Arguments c = app.add_subcommand("serve", "serves API and viewer");
  c.add_option("--host", o->host, "address to listen on").shows_default();
  c.add_option("--port", o->port, "port; 0: any free one").shows_default();
  c.add_option("--data-dir", o->data_dir,
               "folder of sessions and recordings (default: ~/.local/share/truestep)");
  c.add_option("--api-key-file", o->key_file,
               "keys that clients must present, one per line: NAME KEY [admin]");
  c.add_flag("--insecure", o->insecure,
             "serve other machines without keys (the Host header is still checked)");
  c.add_option("--allow-host", o->hosts, "further host names of this server");
  c.add_option("--allow-origin", o->origins, "further allowed origins of browsers");
  c.add_option("--threads", o->threads, "threads that advance sessions (default: all)").in_range(1, 1024);
  c.add_option("--max-memory", o->max_memory_mb, "megabytes of all sessions together")
      .in_range(1.0, 1e9)
      .shows_default();
  c.add_option("--max-message", o->max_message_kib,
               "KiB of a message that a stream's client sends; a longer one closes the stream with 1009")
      .in_range(1, 1 << 20)
      .shows_default();
  c.add_option("--max-sessions", o->max_sessions, "most sessions at once")
      .in_range(1, 1000000)
      .shows_default();
  c.add_option("--session-ttl", o->session_ttl,
               "seconds after which an unused session is saved to disk, or removed if sessions are not kept")
      .in_range(1, 1000000000)
      .shows_default();
  c.add_option("--pause-unwatched", o->pause_unwatched,
               "how long a session keeps playing when its last viewer has left (10s, 5m), or forever; with "
               "\"keep_running\" it always does")
      .shows_default();
  c.add_option("--keep-sessions", o->keep_sessions,
               "how long an unused session stays on disk: 7d, 12h, 30m, 90s, forever; 0: sessions end with "
               "the server or when they are unused for long")
      .shows_default();
  c.add_option("--max-kept", o->max_kept_mb,
               "megabytes of sessions on disk; beyond, those unused longest are removed")
      .in_range(1.0, 1e9)
      .shows_default();
  c.add_option("--keep-recordings", o->keep_recordings, "how long a finished recording stays, or forever")
      .shows_default();
  c.add_option("--max-recordings", o->max_recordings_mb,
               "megabytes of recordings; beyond, no new one begins; 0: no limit")
      .in_range(0.0, 1e12)
      .shows_default();
  c.add_option("--log-level", o->log_level, "log level")
      .one_of({"debug", "info", "warn", "error", "off"})
      .shows_default();
  c.callback([o, &exit_code] { exit_code = serve(*o); });

  auto url = std::make_shared<std::string>("http://127.0.0.1:8080");
  Arguments h = app.add_subcommand("health", "checks that a running server is healthy");
  h.add_option("url", *url, "address of the server").shows_default();
  h.callback([url, &exit_code] { exit_code = health(*url); });
}

}  // namespace truestep
