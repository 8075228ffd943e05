#include "server/tasks/offload.h"

namespace truestep {

void Elsewhere::start(std::coroutine_handle<> handle, Executor& home) {
  executor_.post([this, handle, &home] {
    try {
      work_();
    } catch (...) {
      error_ = std::current_exception();
    }
    home.post([handle] { handle.resume(); });
  });
}

}  // namespace truestep
