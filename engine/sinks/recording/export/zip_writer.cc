#include "engine/sinks/recording/export/zip_writer.h"

#include <zlib.h>

#include <cstring>

namespace truestep::exporting {
namespace {

constexpr uint16_t kVersion = 45;       // 64-bit sizes
constexpr uint16_t kDate = 1 << 5 | 1;  // 1980-01-01: archives of equal data are equal
constexpr uint32_t kSeeExtra = 0xffffffff;

}  // namespace

void ZipWriter::begin(const std::string& name) {
  members_.push_back({name, file_.position(), 0, 0});
  file_.number<uint32_t>(0x04034b50);
  for (uint16_t v : {kVersion, uint16_t{0}, uint16_t{0}, uint16_t{0}, kDate}) file_.number(v);
  for (uint32_t v : {0u, kSeeExtra, kSeeExtra}) file_.number(v);  // checksum later; sizes in the extra field
  file_.number(static_cast<uint16_t>(name.size()));
  file_.number<uint16_t>(20);
  file_.text(name);
  file_.number<uint16_t>(1);
  file_.number<uint16_t>(16);
  for (int i = 0; i < 2; ++i) file_.number<uint64_t>(0);
}

void ZipWriter::bytes(const void* data, size_t size) {
  Member& m = members_.back();
  m.crc = static_cast<uint32_t>(crc32_z(m.crc, static_cast<const Bytef*>(data), size));
  m.size += size;
  file_.bytes(data, size);
}

void ZipWriter::end() {
  const Member& m = members_.back();
  const uint64_t sizes[2] = {m.size, m.size};
  file_.rewrite(m.at + 14, &m.crc, sizeof m.crc);
  file_.rewrite(m.at + 30 + m.name.size() + 4, sizes, sizeof sizes);
}

void ZipWriter::close() {
  const uint64_t directory = file_.position();
  for (const Member& m : members_) {
    file_.number<uint32_t>(0x02014b50);
    for (uint16_t v : {kVersion, kVersion, uint16_t{0}, uint16_t{0}, uint16_t{0}, kDate}) file_.number(v);
    for (uint32_t v : {m.crc, kSeeExtra, kSeeExtra}) file_.number(v);
    for (uint16_t v :
         {static_cast<uint16_t>(m.name.size()), uint16_t{28}, uint16_t{0}, uint16_t{0}, uint16_t{0}}) {
      file_.number(v);
    }
    file_.number<uint32_t>(0);
    file_.number(kSeeExtra);
    file_.text(m.name);
    file_.number<uint16_t>(1);
    file_.number<uint16_t>(24);
    for (uint64_t v : {m.size, m.size, m.at}) file_.number(v);
  }
  const uint64_t end = file_.position(), count = members_.size();
  file_.number<uint32_t>(0x06064b50);  // 64-bit end of directory, its locator, and the short one
  file_.number<uint64_t>(44);
  file_.number(kVersion);
  file_.number(kVersion);
  for (uint32_t v : {0u, 0u}) file_.number(v);
  for (uint64_t v : {count, count, end - directory, directory}) file_.number(v);
  file_.number<uint32_t>(0x07064b50);
  file_.number<uint32_t>(0);
  file_.number(end);
  file_.number<uint32_t>(1);
  file_.number<uint32_t>(0x06054b50);
  for (uint16_t v : {uint16_t{0}, uint16_t{0}, uint16_t{0xffff}, uint16_t{0xffff}}) file_.number(v);
  for (uint32_t v : {kSeeExtra, kSeeExtra}) file_.number(v);
  file_.number<uint16_t>(0);
  file_.close();
}

}  // namespace truestep::exporting
