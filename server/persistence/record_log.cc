#include "server/persistence/record_log.h"

#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "server/persistence/files.h"

namespace truestep {

namespace {

constexpr size_t kUnit = 32, kHead = 8, kNumbers = 24;

template <class T>
T get(std::span<const std::byte> bytes, size_t at) {
  T v;
  std::memcpy(&v, bytes.data() + at, sizeof v);
  return v;
}

size_t rounded(size_t size) {
  return (size + kUnit - 1) / kUnit * kUnit;
}

uint32_t sum_of(const std::byte* record, size_t body) {
  const auto* bytes = reinterpret_cast<const Bytef*>(record);
  return static_cast<uint32_t>(crc32_z(crc32_z(0, bytes, 4), bytes + kHead, body));
}

}  // namespace

Bytes record_bytes(const LogRecord& record) {
  const size_t body = kNumbers + record.text.size();
  Bytes out(rounded(kHead + body));
  const auto put = [&](size_t at, const auto& v) { std::memcpy(out.data() + at, &v, sizeof v); };
  put(0, static_cast<uint32_t>(body));
  put(8, static_cast<uint64_t>(record.kind));
  put(16, record.step);
  put(24, record.sequence);
  if (!record.text.empty())
    std::memcpy(out.data() + kHead + kNumbers, record.text.data(), record.text.size());
  put(4, sum_of(out.data(), body));
  return out;
}

namespace {

// Size of the complete record that the bytes begin with; 0 when there is none.
size_t whole_record(std::span<const std::byte> bytes) {
  if (bytes.size() < kUnit) return 0;
  const size_t body = get<uint32_t>(bytes, 0), size = rounded(kHead + body);
  if (body < kNumbers || size > bytes.size() || get<uint32_t>(bytes, 4) != sum_of(bytes.data(), body))
    return 0;
  const auto padding = bytes.subspan(kHead + body, size - kHead - body);
  const bool padded =
      std::all_of(padding.begin(), padding.end(), [](std::byte b) { return b == std::byte{0}; });
  const bool known = get<uint64_t>(bytes, 8) <= static_cast<uint64_t>(LogRecord::Kind::stands);
  return padded && known ? size : 0;
}

}  // namespace

LogContents read_records(std::span<const std::byte> file) {
  LogContents out;
  size_t size = 0;
  for (; (size = whole_record(file)) > 0; file = file.subspan(size)) {
    LogRecord& r = out.records.emplace_back();
    r.kind = static_cast<LogRecord::Kind>(get<uint64_t>(file, 8));
    r.step = get<uint64_t>(file, 16);
    r.sequence = get<uint64_t>(file, 24);
    r.text = text_of(file.subspan(kHead + kNumbers, get<uint32_t>(file, 0) - kNumbers));
  }
  if (file.empty()) return out;
  // Only the last record can have been cut short by a kill; anything else invalid is damage, with records
  // behind it.
  out.end = LogContents::End::torn;
  for (size_t at = kUnit; at < file.size(); at += kUnit) {
    if (whole_record(file.subspan(at)) > 0) out.end = LogContents::End::damaged;
  }
  return out;
}

RecordLog::~RecordLog() {
  files_.close(this);
}

void RecordLog::append(const LogRecord& record) {
  const Bytes bytes = record_bytes(record);
  const bool stands = record.kind == LogRecord::Kind::stands;
  const uint64_t at = stands && standing_ ? *standing_ : end_;
  const auto file = files_.open(this, place_);
  // What is written to a file without a name is gone with the process.
  struct stat about {};
  if (::fstat(file->get(), &about) == 0 && about.st_nlink == 0) {
    files_.close(this);
    throw_file_error("write the journal", ENOENT);
  }
  size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n =
        ::pwrite(file->get(), bytes.data() + done, bytes.size() - done, static_cast<off_t>(at + done));
    if (n < 0 && errno == EINTR) continue;
    if (n > 0) {
      done += static_cast<size_t>(n);
      continue;
    }
    const int code = n < 0 ? errno : ENOSPC;
    [[maybe_unused]] const int cut = ::ftruncate(file->get(), static_cast<off_t>(end_));
    throw_file_error("write the journal", code);
  }
  if (at == end_) end_ += bytes.size();
  standing_ = stands ? std::optional(at) : std::nullopt;
}

}  // namespace truestep
