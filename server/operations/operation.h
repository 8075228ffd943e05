// Long-running work started by a request: its progress, end and result, watched and cancelled by id.
#pragma once
#include <atomic>
#include <boost/json.hpp>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/errors.h"
#include "engine/studies/study.h"
#include "server/tasks/offload.h"
#include "server/tasks/signal.h"

namespace truestep {

enum class OperationStatus : uint8_t { waiting, running, done, failed, cancelled };

std::string_view status_name(OperationStatus status);

/// What is known about an operation at one moment.
struct OperationView {
  OperationStatus status = OperationStatus::waiting;
  double progress = 0;  ///< 0 to 1
  std::string note;
  std::optional<Error> error;                 ///< failed
  std::shared_ptr<const StudyResult> result;  ///< done
  bool ended() const { return status >= OperationStatus::done; }
};

class Operation {
 public:
  Operation(std::string id, StudyRequest request, std::string request_text)
      : id(std::move(id)), request(std::move(request)), request_text(std::move(request_text)) {}

  const std::string id;
  std::string owner;  ///< name of the key that started it
  const StudyRequest request;
  const std::string request_text;  ///< canonical JSON; rows can be reused only by the same request
  std::atomic<bool> cancelled{false};
  Signal changed;  ///< raised after every change of the view

  OperationView view() const;
  /// The finished rows of a sweep so far.
  std::vector<boost::json::object> rows() const;
  /// Asks the work to stop; an operation that is still queued ends at once.
  void cancel();
  /// Does the work in the calling thread. `earlier` are the rows of an interrupted sweep.
  void run(const ThreadArena& arena, std::vector<boost::json::object> earlier,
           std::function<void(const Cost&)> admit);

 private:
  void end(OperationStatus status, std::optional<Error> error, std::shared_ptr<const StudyResult> result);

  mutable std::mutex mutex_;
  OperationView view_;
  std::vector<boost::json::object> rows_;
};

using OperationPtr = std::shared_ptr<Operation>;

}  // namespace truestep
