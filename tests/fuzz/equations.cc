// Systems of equations: the bytes are texts, one per line, which become a system of two states, an array, a
// definition and an event; whatever the texts are, they compile and step, or are refused with a pointer.
#include <cstddef>
#include <cstdint>
#include <string>

#include "engine/systems/ode/ode.h"

namespace {

using namespace truestep;
using namespace truestep::ode;

OdeDef system_of(const uint8_t* data, size_t size) {
  std::string lines[8];
  size_t line = 0;
  for (size_t k = 0; k < size && line < 8; ++k) {
    if (data[k] == '\n') {
      ++line;
    } else {
      lines[line] += static_cast<char>(data[k]);
    }
  }
  OdeDef d;
  d.states = {{"x", {1}, NamedNumbers::Form::number},
              {"y", {0.5}, NamedNumbers::Form::number},
              {"a", {0.1, 0.2, 0.3}, NamedNumbers::Form::array}};
  d.parameters = {{"k", {2}, NamedNumbers::Form::number}};
  d.let = {{lines[4].empty() ? "d[i, j]" : "d[i]", "a[i] - 1"}, {"g", lines[5].empty() ? "1" : lines[5]}};
  d.equations = {{"x", lines[0]}, {"y", lines[1]}, {"a[i]", lines[2]}};
  OdeEventDef event;
  event.when = lines[3].empty() ? "x" : lines[3];
  event.set = {{lines[6].empty() ? "y" : lines[6], lines[4].empty() ? "0" : lines[4]}};
  d.events = {event};
  return d;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  // The expansion of a text is bounded but slow under sanitizers: long inputs only repeat.
  if (size > 600) return 0;
  const OdeDef def = system_of(data, size);
  try {
    const Ode system(def, BuildContext{.id = "f", .dt = 0.01});
    State state = system.initial_state();
    Workspace workspace;
    const ThreadArena arena(1);
    for (uint64_t n = 0; n < 2; ++n) {
      system.step(
          state,
          {.t = static_cast<double>(n) * 0.01, .h = 0.01, .step = n, .workspace = workspace, .arena = arena});
    }
    Observables seen;
    system.observe(state, 0.02, seen);
  } catch (const Instability&) {
  } catch (const Error& error) {
    if (error.code() != "scene_invalid" || error.issues().empty() || error.issues()[0].pointer.empty())
      __builtin_trap();
  }
  return 0;
}
