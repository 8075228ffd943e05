// How a scene describes the shapes of ropes, hair, cloth and soft blocks, shared by every system made of
// points.
#pragma once
#include "engine/core/def/def.h"
#include "engine/geometry/make/cloth_grid.h"
#include "engine/geometry/make/hair.h"
#include "engine/geometry/make/helix.h"
#include "engine/geometry/make/rope.h"
#include "engine/geometry/make/soft_block.h"
#include "engine/geometry/make/surface.h"

namespace truestep {

const DefTable& rope_shape_table();
const DefTable& hair_shape_table();
const DefTable& helix_shape_table();
const DefTable& cloth_grid_shape_table();
const DefTable& mesh_shape_table();
const DefTable& soft_block_shape_table();

}  // namespace truestep
