// The envelope of files exchanged between Truesteps (snapshots, bundles): kind, version, length, and a
// checksum over all of it, so that a truncated, damaged or foreign file is recognised before any of its
// contents is used. Little-endian:
//   8 bytes name | u32 version | u32 0 | u64 size of the contents | contents | u64 XXH3 of everything before
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace truestep {

using Bytes = std::vector<std::byte>;

/// A kind of file.
struct SealKind {
  std::string_view name;  ///< 8 characters
  uint32_t version;       ///< written by this build, and the newest that it reads
  const char* error;      ///< code of the errors thrown
  const char* what;       ///< "snapshot"
};

Bytes seal(const SealKind& kind, std::span<const std::byte> contents);
/// The contents, as a view into the file. Error with the kind's code.
std::span<const std::byte> unseal(const SealKind& kind, std::span<const std::byte> file);

/// Reads numbers, texts and blocks from the contents; running past their end is an Error with the kind's
/// code.
class SealedReader {
 public:
  SealedReader(const SealKind& kind, std::span<const std::byte> contents) : kind_(kind), rest_(contents) {}
  uint64_t number();
  std::span<const std::byte> block();
  std::string text();
  bool done() const { return rest_.empty(); }
  [[noreturn]] void fail(const std::string& why) const;

 private:
  std::span<const std::byte> take(uint64_t size);
  const SealKind& kind_;
  std::span<const std::byte> rest_;
};

/// Writes what SealedReader reads.
class SealedWriter {
 public:
  void number(uint64_t v);
  void block(std::span<const std::byte> bytes);
  void text(std::string_view s) { block(std::as_bytes(std::span(s.data(), s.size()))); }
  const Bytes& contents() const { return out_; }

 private:
  Bytes out_;
};

}  // namespace truestep
