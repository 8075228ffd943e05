// The operations of a server: one runs at a time (timed studies must not disturb each other), the others wait
// in order, and the most recent ended ones are kept for their results.
#pragma once
#include <deque>
#include <map>
#include <mutex>

#include "engine/scene/admission.h"
#include "server/net/http/message.h"
#include "server/net/worker_pool.h"
#include "server/operations/operation.h"
#include "server/sessions/memory_budget.h"

namespace truestep {

struct OperationLimits {
  size_t waiting = 32;       ///< of one key, that have not ended
  size_t all_waiting = 512;  ///< of all keys
  size_t kept = 256;         ///< of one key; beyond this its oldest ended ones are forgotten
  AdmissionLimits per_run;   ///< what one run of the scene may cost
};

class OperationStore {
 public:
  OperationStore(OperationLimits limits, int threads, MemoryBudget& budget);
  ~OperationStore();

  /// Queues the work. `resume` is the id of an earlier sweep of the same request, or empty. Error
  /// quota_exceeded, unknown_operation, or conflict when the earlier request was another.
  OperationPtr start(StudyRequest request, const std::string& request_text, std::string_view resume,
                     const net::Caller& owner);
  /// Error unknown_operation, also for an operation that the caller may not see.
  OperationPtr find(std::string_view id, const net::Caller& caller) const;
  /// Cancels and forgets an operation.
  void remove(const OperationPtr& operation);
  /// The operations that the caller may see.
  std::vector<OperationPtr> all(const net::Caller& caller) const;
  /// Asks all of them to stop.
  void cancel_all();
  /// Cancels everything and waits for the thread.
  void stop();

 private:
  void forget_oldest(const std::string& owner);
  OperationLimits limits_;
  MemoryBudget& budget_;
  ThreadArena arena_;
  mutable std::mutex mutex_;
  std::map<std::string, OperationPtr, std::less<>> operations_;
  std::deque<std::string> order_;
  net::WorkerPool thread_{1};
};

}  // namespace truestep
