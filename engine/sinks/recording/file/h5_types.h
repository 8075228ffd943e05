// The element types of a recording in HDF5's terms, and H5MD's boundary attribute.
#pragma once
#include "engine/sinks/recording/file/h5.h"
#include "engine/sinks/recording/log/chunk_plan.h"

namespace truestep {

/// Little-endian file type of `type`; not owned by the caller.
hid_t h5_file_type(ElementType type);

/// H5MD: a box without walls or periods, boundary = {none, none, none}.
void h5_boundary_none(hid_t box);

}  // namespace truestep
