// What a parameter struct holds on the heap, by its table: the texts, lists and nested structs that a scene's
// definition consists of. A scene keeps its definition as long as it runs, and of a scene with tables of
// measured points that is most of its memory.
#pragma once
#include "engine/core/def/def.h"

namespace truestep {

/// Bytes that the members of `owner` hold outside of it. Nothing of `owner` itself, whose size the table does
/// not say.
double heap_bytes(const DefTable& table, const void* owner);

}  // namespace truestep
