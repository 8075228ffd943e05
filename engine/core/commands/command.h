// What a user does to a running session. Commands take effect at step boundaries, in the order of their
// sequence numbers, and are journalled: replaying the journal repeats the run.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "engine/math/vec3.h"

namespace truestep {

enum class CommandKind : uint8_t {
  push,           ///< force `vector` (N) on row `index` for `duration` seconds (0: one step)
  impulse,        ///< impulse `vector` (N s) on row `index` at once
  drag,           ///< spring of stiffness `value` (N/m, 0: the system's choice) from row `index` to `vector`
  release,        ///< ends the drag of row `index`; index -1 ends all
  pin,            ///< holds row `index` where it is
  unpin,          ///< lets row `index` go
  set_parameter,  ///< parameter `name` := `value` (SI) or `vector`
  spawn,          ///< new element at `vector` with `velocity`
  remove,         ///< removes row `index`
};

struct Command {
  CommandKind kind = CommandKind::push;
  std::string system;  ///< id of the system it is for
  int64_t index = -1;
  Vec3 vector, velocity;
  double value = 0;
  double duration = 0;     ///< s
  std::string name;        ///< parameter of set_parameter
  std::optional<Vec3> at;  ///< m, where on a body a push, impulse or drag acts; none: the centre of mass
};

}  // namespace truestep
