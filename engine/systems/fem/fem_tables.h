// Tables of the objects in a scene's "fem".
#pragma once
#include "engine/systems/fem/fem_def.h"

namespace truestep::fem {

const DefTable& quad_table();
const DefTable& cells_table();
const DefTable& fill_table();
const DefTable& set_table();
const DefTable& copy_table();
const DefTable& hold_table();
const DefTable& load_table();

}  // namespace truestep::fem
