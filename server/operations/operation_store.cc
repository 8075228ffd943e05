#include "server/operations/operation_store.h"

#include <algorithm>

#include "server/sessions/lane.h"
#include "server/sessions/store.h"

namespace truestep {

namespace {
constexpr int kNice = 12;
}

OperationStore::OperationStore(OperationLimits limits, int threads, MemoryBudget& budget)
    : limits_(limits), budget_(budget), arena_(threads) {
  thread_.post([] { yield_to_others(kNice); });
}

OperationStore::~OperationStore() {
  stop();
}

OperationPtr OperationStore::start(StudyRequest request, const std::string& request_text,
                                   std::string_view resume, const net::Caller& owner) {
  // A run, the reference it is compared with, and what both keep for the comparison.
  constexpr double kCopies = 3;
  const Cost cost = estimate(require_scene(read_scene(request.scene)));
  require_admission(cost, limits_.per_run);
  auto lease = budget_.lease(kCopies * (cost.state_bytes + cost.workspace_bytes), "this study");
  std::vector<boost::json::object> earlier;
  if (!resume.empty()) {
    const OperationPtr before = find(resume, owner);
    if (before->request_text != request_text)
      throw Error("conflict", "the operation to resume was started by a different request");
    earlier = before->rows();
  }
  auto operation = std::make_shared<Operation>(random_session_id(), std::move(request), request_text);
  operation->owner = owner.name;
  {
    const std::lock_guard lock(mutex_);
    size_t own = 0, all = 0;
    for (const auto& [id, o] : operations_) {
      if (o->view().ended()) continue;
      ++all;
      own += o->owner == owner.name;
    }
    if (own >= limits_.waiting || all >= limits_.all_waiting)
      throw Error("quota_exceeded", own >= limits_.waiting
                                        ? std::to_string(own) + " operations of this key are waiting already"
                                        : std::to_string(all) + " operations are waiting already");
    operations_[operation->id] = operation;
    order_.push_back(operation->id);
    forget_oldest(owner.name);
  }
  const auto held = std::make_shared<MemoryBudget::Lease>(std::move(lease));
  thread_.post([this, operation, held, earlier = std::move(earlier)]() mutable {
    std::mutex several;  // cases of a sweep come from several threads
    operation->run(arena_, std::move(earlier), [&](const Cost& variant) {
      require_admission(variant, limits_.per_run);
      const std::lock_guard lock(several);
      held->require(std::max(held->bytes(), kCopies * (variant.state_bytes + variant.workspace_bytes)),
                    "a variant of the scene");
    });
  });
  return operation;
}

void OperationStore::forget_oldest(const std::string& owner) {
  auto kept = static_cast<size_t>(std::count_if(operations_.begin(), operations_.end(),
                                                [&](const auto& o) { return o.second->owner == owner; }));
  for (auto it = order_.begin(); it != order_.end() && kept > limits_.kept;) {
    const auto found = operations_.find(*it);
    if (found->second->owner != owner || !found->second->view().ended()) {
      ++it;
      continue;
    }
    operations_.erase(found);
    it = order_.erase(it);
    --kept;
  }
}

OperationPtr OperationStore::find(std::string_view id, const net::Caller& caller) const {
  const std::lock_guard lock(mutex_);
  const auto it = operations_.find(id);
  if (it == operations_.end() || !caller.may_see(it->second->owner))
    throw Error("unknown_operation", "there is no operation with this id");
  return it->second;
}

void OperationStore::remove(const OperationPtr& operation) {
  operation->cancel();
  const std::lock_guard lock(mutex_);
  operations_.erase(operation->id);
  std::erase(order_, operation->id);
}

std::vector<OperationPtr> OperationStore::all(const net::Caller& caller) const {
  const std::lock_guard lock(mutex_);
  std::vector<OperationPtr> out;
  for (const std::string& id : order_) {
    const auto it = operations_.find(id);
    if (it != operations_.end() && caller.may_see(it->second->owner)) out.push_back(it->second);
  }
  return out;
}

void OperationStore::cancel_all() {
  for (const OperationPtr& o : all({})) o->cancel();
}

void OperationStore::stop() {
  cancel_all();
  thread_.join();
}

}  // namespace truestep
