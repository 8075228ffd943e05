// The files from which a session is restored. A first byte of 0: the rest is a log; 1: a saved state; 2: two
// bytes with its size (high byte first), a saved state and a log. What is read is refused with
// "session_damaged" or gives a history whose commands are in order.
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "engine/base/errors.h"
#include "server/persistence/sessions/saved_session.h"

namespace {

using namespace truestep;

void check(const LoggedCourse& course) {
  for (size_t k = 1; k < course.journal.size(); ++k) {
    if (course.journal[k].step < course.journal[k - 1].step) __builtin_trap();
  }
  if (course.step > kMostStep) __builtin_trap();
}

void check_log(std::span<const std::byte> bytes, const SavedState& state) {
  const LogContents read = read_records(bytes);
  Bytes again;
  for (const LogRecord& r : read.records) {
    const Bytes one = record_bytes(r);
    again.insert(again.end(), one.begin(), one.end());
  }
  if (again.size() > bytes.size() || !std::equal(again.begin(), again.end(), bytes.begin())) __builtin_trap();
  check(follow(state, state.ahead.empty() ? 0 : state.ahead.front().step, read.records));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const auto rest = std::as_bytes(std::span(data + 1, size - 1));
  try {
    if (data[0] == 0) check_log(rest, {});
    if (data[0] == 1) read_saved_state(rest);
    if (data[0] == 2 && size > 3) {
      const auto both = rest.subspan(2);
      const size_t first = std::min(size_t{data[1]} << 8 | data[2], both.size());
      check_log(both.subspan(first), read_saved_state(both.first(first)));
    }
  } catch (const Error& e) {
    if (e.code() != "session_damaged") __builtin_trap();
  }
  return 0;
}
