// Repairs an HDF5 superblock (version 3) after a crash, in a copy of the file: clears the writer's marks and
// sets the real end of file. Like h5clear, but without opening the file for writing, which would cut off
// everything behind the recorded end. Source: HDF5 file format specification 3.0, superblock version 2 and 3;
// checksum: B. Jenkins, lookup3, 2006.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace truestep {

/// Jenkins' lookup3 hash of bytes with initial value 0: the checksum of HDF5's metadata.
uint32_t lookup3(const void* data, size_t size);

/// The same for a file in memory that begins so and ends at `end`.
bool repair_superblock(std::span<std::byte> start, uint64_t end);
/// Edits the file in place; false when it does not start with such a superblock or cannot be written.
bool repair_superblock(const std::string& path);

}  // namespace truestep
