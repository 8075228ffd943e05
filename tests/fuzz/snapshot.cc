// Snapshots of worlds. The first byte selects a scene; the rest are edits (place, value) of the bytes of one
// of its states: the result is refused with "bad_snapshot" or can be stepped, observed and saved again. With
// a first byte of 255 the rest is a snapshot file.
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "engine/base/errors.h"
#include "engine/scene/scene.h"
#include "engine/session/session.h"
#include "engine/session/snapshot/snapshot.h"
#include "time_limit.h"

namespace {

using namespace truestep;

constexpr const char* kScenes[] = {
    R"({"systems": [{"type": "rigid2d", "bodies": [{"motion": "fixed", "shapes": [{"type": "box", "half_extents": [5, 0.1, 0]}]},
        {"position": [0, 0.5, 0], "shapes": [{"type": "box"}]}, {"position": [0.1, 1.6, 0], "shapes": [{"type": "circle"}]}],
        "joints": [{"type": "distance", "a": 1, "b": 2, "anchor_b": [0, 0.1, 0]}]}]})",
    R"({"systems": [{"type": "rigid3d", "bodies": [{"type": "plane", "motion": "fixed"}, {"type": "box", "position": [0, 0.5, 0]},
        {"type": "sphere", "position": [0.1, 1.4, 0]}]}]})",
    R"({"systems": [{"type": "particles", "positions": [[0, 1, 0], [1, 1, 0], [2, 1, 0]], "springs": [{"a": 0, "b": 1, "stiffness": 10}],
        "emitters": [{"rate": 100}]}]})",
    R"({"systems": [{"type": "mass_spring", "pinned": ["first"], "rope": {"from": [0, 1, 0], "to": [1, 1, 0], "links": 5}}]})",
    R"({"systems": [{"type": "articulation", "links": [{"mass": 1, "center": [0.5, 0, 0], "inertia": [0.1, 0.1, 0.1]}]}]})",
    R"({"systems": [{"type": "pendulum", "links": 2, "angle": 1}]})",
    R"({"systems": [{"type": "oscillator", "stiffness": 10, "position": 1}]})",
    R"({"systems": [{"type": "ode", "states": {"x": 1, "v": 0}, "equations": {"x": "v", "v": "-x"},
        "events": [{"name": "bounce", "when": "x", "direction": "falling", "set": {"v": "-0.5*v"}}]}]})",
};
constexpr size_t kCount = std::size(kScenes);

struct Case {
  std::shared_ptr<const World> world;
  std::vector<std::byte> bytes;
};

const std::shared_ptr<const ThreadArena>& arena() {
  static const auto a = std::make_shared<const ThreadArena>(1);
  return a;
}

// A state with contacts, pushes and drags.
Case make(const char* text) {
  Case c{std::make_shared<const World>(parse_scene(text)), {}};
  Session session(c.world, arena(), {.history_bytes = 0});
  session.step(20);
  for (const CommandKind kind : {CommandKind::push, CommandKind::drag}) {
    Command command;
    command.kind = kind, command.system = c.world->id(0), command.index = 0, command.duration = 10;
    command.vector = {0, 1, 0}, command.value = 1;
    try {
      session.command(command);
    } catch (const Error&) {
    }
  }
  session.step(1);
  c.bytes = session.state().serialize();
  return c;
}

void step(const std::shared_ptr<const World>& world, WorldState state) {
  Session session(world, arena(), {.history_bytes = 0});
  session.restore(std::move(state));
  const TimeLimit limit;
  session.step(2);
  session.observe();
  write_snapshot(*world, session.state());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::vector<Case> cases = [] {
    std::vector<Case> all;
    for (const char* text : kScenes) all.push_back(make(text));
    return all;
  }();
  if (size == 0) return 0;
  try {
    if (data[0] == 255) {
      const auto file = std::as_bytes(std::span(data + 1, size - 1));
      step(cases[3].world, read_snapshot(*cases[3].world, file));
      return 0;
    }
    const Case& c = cases[data[0] % kCount];
    auto bytes = c.bytes;
    for (size_t i = 1; i + 3 <= size && i < 3 * 64; i += 3) {
      const size_t at = (size_t{data[i]} << 8 | data[i + 1]) % bytes.size();
      bytes[at] = std::byte(data[i + 2]);
    }
    step(c.world, WorldState::deserialize(bytes));
  } catch (const Error& error) {
    if (error.code() != "bad_snapshot" && error.code() != "instability" && error.code() != "cancelled")
      __builtin_trap();
  }
  return 0;
}
