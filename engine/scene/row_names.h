// Ids that a scene gives to bodies and joints of its systems, for commands that name a row by its id.
#pragma once
#include <string>
#include <vector>

#include "engine/scene/scene.h"

namespace truestep {

struct NamedRow {
  std::string id;
  size_t row;  ///< of a body: see RowNames::bodies_are
};
struct RowNames {
  std::vector<NamedRow> bodies, joints;
  enum class BodiesAre : uint8_t {
    rows,  ///< `row` of a body is its row, for ever
    forms  ///< it is the form (core/ports/body_port.h) that its rows have: they come, go and move
  } bodies_are = BodiesAre::rows;
};

/// Where the rows of an entry of "bodies" begin at t = 0, and how many it has.
struct FirstRow {
  std::string id;
  size_t row, count;
};
/// Of the bodies that have an id; of the joints of a skeleton.
std::vector<FirstRow> first_rows(const SceneSystem& system);

/// `joints`: rows of the system's part "joints".
RowNames row_names(const SceneSystem& system, size_t joints);

}  // namespace truestep
