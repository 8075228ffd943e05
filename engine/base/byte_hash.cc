#include "engine/base/byte_hash.h"

#include <xxhash.h>

namespace truestep {

uint64_t byte_hash(const void* data, size_t size, uint64_t before) {
  return XXH3_64bits_withSeed(data, size, before);
}

}  // namespace truestep
