// A log of records: what happened to a session since its last saved state, in order, each written before it
// takes effect. A write that a kill cut short leaves a record whose checksum is wrong; what precedes it is
// valid.
//   record = u32 size of the body | u32 CRC-32 of size and body | body | zeros to a multiple of 32
//   body   = u64 kind | u64 step | u64 sequence | text
// (little-endian). Records begin at multiples of 32 bytes, so one without a text lies within a page and is
// written as a whole or not at all. A record of where the session stands is replaced by the next such one.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/session/snapshot/sealed.h"
#include "server/persistence/open_files.h"

namespace truestep {

struct LogRecord {
  enum class Kind : uint8_t {
    continues,  ///< continues the log before it
    anew,       ///< starts afresh: nothing before counts, only the saved state of the same number
    command,    ///< `text` is about to be carried out at `step`, which discards commands of later steps
    refused,    ///< the command of that number was refused
    stands,     ///< the session has reached `step`
  };
  Kind kind = Kind::stands;
  uint64_t step = 0, sequence = 0;
  std::string text;
  friend bool operator==(const LogRecord&, const LogRecord&) = default;
};

Bytes record_bytes(const LogRecord& record);

struct LogContents {
  std::vector<LogRecord> records;
  /// Whether the records are followed by one that was cut short, the mark of a killed writer.
  enum class End : uint8_t { clean, torn, damaged } end = End::clean;
};
LogContents read_records(std::span<const std::byte> file);

/// The writing end. One thread at a time.
class RecordLog {
 public:
  /// Creates the file on the first append.
  RecordLog(Place place, OpenFiles& files) : place_(std::move(place)), files_(files) {}
  ~RecordLog();
  RecordLog(const RecordLog&) = delete;
  RecordLog& operator=(const RecordLog&) = delete;

  /// Error "disk_full" or "folder_io"; the file then keeps its previous end.
  void append(const LogRecord& record);
  uint64_t bytes() const { return end_; }

 private:
  const Place place_;
  OpenFiles& files_;
  uint64_t end_ = 0;
  std::optional<uint64_t> standing_;  ///< offset of the record of kind `stands` that ends the file
};

}  // namespace truestep
