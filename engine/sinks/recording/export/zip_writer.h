// A zip archive of stored (not compressed) members, each written in pieces; always with 64-bit sizes.
// Source: PKWARE APPNOTE 6.3, sections 4.3.7, 4.3.12, 4.3.14-16, 4.5.3.
#pragma once
#include <string>
#include <vector>

#include "engine/sinks/recording/export/export_parts.h"

namespace truestep::exporting {

class ZipWriter {
 public:
  explicit ZipWriter(const std::string& path) : file_(path) {}
  void begin(const std::string& name);
  void bytes(const void* data, size_t size);
  void end();    ///< completes the member that was begun
  void close();  ///< writes the directory
 private:
  struct Member {
    std::string name;
    uint64_t at = 0, size = 0;
    uint32_t crc = 0;
  };
  OutputFile file_;
  std::vector<Member> members_;
};

}  // namespace truestep::exporting
