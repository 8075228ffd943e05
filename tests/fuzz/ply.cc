// PLY files: whatever the bytes are, they are a surface or a fault with its place.
#include "engine/geometry/read/ply.h"

#include "tests/fuzz/mesh_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return check_surface_reader(truestep::read_ply, data, size);
}
