#include "server/tasks/task.h"

namespace truestep {

std::coroutine_handle<> task_detail::Promise::next() noexcept {
  ended = true;
  if (starting) return std::noop_coroutine();
  if (continuation) return continuation;
  // The call may destroy the root, the coroutine and with it this promise.
  const auto tell = std::move(root->ended_);
  tell(error);
  return std::noop_coroutine();
}

RootTask::RootTask(Task<void> task, TaskContext& context, std::function<void(std::exception_ptr)> ended)
    : task_(std::move(task)), ended_(std::move(ended)) {
  task_.run_in(context);
  task_.handle_.promise().root = this;
}

}  // namespace truestep
