#include "server/operations/operation.h"

#include "engine/base/interrupt.h"
#include "engine/base/log.h"

namespace truestep {

std::string_view status_name(OperationStatus status) {
  constexpr std::string_view kNames[] = {"waiting", "running", "done", "failed", "cancelled"};
  return kNames[static_cast<size_t>(status)];
}

OperationView Operation::view() const {
  const std::lock_guard lock(mutex_);
  return view_;
}

std::vector<boost::json::object> Operation::rows() const {
  const std::lock_guard lock(mutex_);
  return rows_;
}

void Operation::cancel() {
  cancelled = true;
  {
    const std::lock_guard lock(mutex_);
    if (view_.status != OperationStatus::waiting) return;
    view_.status = OperationStatus::cancelled;
  }
  changed.notify();
}

void Operation::run(const ThreadArena& arena, std::vector<boost::json::object> earlier,
                    std::function<void(const Cost&)> admit) {
  {
    const std::lock_guard lock(mutex_);
    if (view_.ended()) return;
    view_.status = OperationStatus::running;
    rows_ = earlier;
  }
  changed.notify();
  auto last = std::chrono::steady_clock::now();
  StudyContext context{
      .arena = arena, .cancelled = cancelled, .progress = [&](double fraction, const std::string& note) {
        {
          const std::lock_guard lock(mutex_);
          view_.progress = fraction;
          view_.note = note;
        }
        // Ten updates a second are enough for watchers.
        const auto now = std::chrono::steady_clock::now();
        if (now - last < std::chrono::milliseconds(100)) return;
        last = now;
        changed.notify();
      }};
  context.finished_rows = std::move(earlier);
  context.admit = std::move(admit);
  context.row_finished = [this](const boost::json::object& row) {
    const std::lock_guard lock(mutex_);
    rows_.push_back(row);
  };
  try {
    // Also inside a step and while a world is being built.
    const InterruptScope scope(&cancelled);
    end(OperationStatus::done, std::nullopt,
        std::make_shared<const StudyResult>(run_study(request, context)));
  } catch (const Error& e) {
    end(e.code() == "cancelled" ? OperationStatus::cancelled : OperationStatus::failed, e, nullptr);
  } catch (const std::exception& e) {
    log_error("operation {}: {}", id, e.what());
    end(OperationStatus::failed, Error("internal", "the study failed"), nullptr);
  }
}

void Operation::end(OperationStatus status, std::optional<Error> error,
                    std::shared_ptr<const StudyResult> result) {
  {
    const std::lock_guard lock(mutex_);
    view_.status = status;
    view_.error = std::move(error);
    view_.result = std::move(result);
    if (status == OperationStatus::done) view_.progress = 1;
  }
  changed.notify();
}

}  // namespace truestep
