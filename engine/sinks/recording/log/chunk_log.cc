#include "engine/sinks/recording/log/chunk_log.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "engine/base/errors.h"
#include "engine/base/hash.h"
#include "engine/sinks/recording/file/layout_bytes.h"
#include "engine/sinks/recording/file/plain_file.h"
#include "engine/sinks/recording/file/superblock.h"

namespace truestep {
namespace {

constexpr char kHead[8] = {'T', 'S', 'C', 'H', 'U', 'N', 'K', '2'};
constexpr char kRecord[4] = {'C', 'R', 'E', 'C'};
constexpr size_t kWholeBytes = 2048;  // below this size, HDF5 may pack chunks closer than pages

void put(std::vector<std::byte>& to, const void* data, size_t size) {
  const auto* p = static_cast<const std::byte*>(data);
  to.insert(to.end(), p, p + size);
}
template <typename T>
void put(std::vector<std::byte>& to, T value) {
  put(to, &value, sizeof value);
}
void put_sum(std::vector<std::byte>& to, size_t from) {
  put(to, lookup3(to.data() + from, to.size() - from));
}

template <typename T>
std::optional<T> get(std::span<const std::byte>& from) {
  if (from.size() < sizeof(T)) return std::nullopt;
  T value;
  std::memcpy(&value, from.data(), sizeof value);
  from = from.subspan(sizeof value);
  return value;
}

// The body of a block: mark | size | body | sum.
template <typename Size, size_t kMark>
std::optional<std::span<const std::byte>> take_block(const char (&mark)[kMark],
                                                     std::span<const std::byte>& from) {
  constexpr size_t kBefore = kMark + sizeof(Size);
  if (from.size() < kBefore + 4 || std::memcmp(from.data(), mark, kMark) != 0) return std::nullopt;
  Size size;
  std::memcpy(&size, from.data() + kMark, sizeof size);
  if (size > from.size() - kBefore - 4) return std::nullopt;
  uint32_t sum;
  std::memcpy(&sum, from.data() + kBefore + size, sizeof sum);
  if (sum != lookup3(from.data(), kBefore + size)) return std::nullopt;
  const auto body = from.subspan(kBefore, size);
  from = from.subspan(kBefore + size + 4);
  return body;
}

std::optional<LoggedChunks::Batch> read_batch(std::span<const std::byte> body, const ChunkPlan& plan) {
  LoggedChunks::Batch batch;
  const auto frames = get<uint64_t>(body);
  if (!frames || *frames == 0 || *frames > plan.frames) return std::nullopt;
  batch.frames = *frames;
  for (const PlannedArray& a : plan.arrays) {
    if (is_logged_whole(a)) {
      const size_t size = a.chunk_bytes + 4;
      if (body.size() < size) return std::nullopt;
      put(batch.whole, body.data(), size);
      body = body.subspan(size);
      continue;
    }
    const auto count = get<uint64_t>(body);
    if (!count || *count > a.chunks || *count > body.size() / 8) return std::nullopt;
    auto& keys = batch.keys.emplace_back(*count);
    if (*count > 0) std::memcpy(keys.data(), body.data(), 8 * *count);
    body = body.subspan(8 * *count);
  }
  return body.empty() ? std::optional(std::move(batch)) : std::nullopt;
}

}  // namespace

std::string chunk_log_path(const std::string& recording) {
  return recording + std::string(kChunkLogEnding);
}

bool is_logged_whole(const PlannedArray& a) {
  return a.chunk_bytes <= kWholeBytes;
}

// The checksum covers every byte; the samples make a collision as unlikely as 64 bits allow.
uint64_t chunk_key(const std::byte* chunk, size_t size) {
  constexpr size_t kSamples = 16, kBytes = 16;
  std::array<std::byte, kSamples * kBytes + 4> sample;
  for (size_t k = 0; k < kSamples; ++k) {
    const size_t at = (size - kBytes) * k / (kSamples - 1);
    std::memcpy(sample.data() + k * kBytes, chunk + at, kBytes);
  }
  std::memcpy(sample.data() + kSamples * kBytes, chunk + size, 4);
  Hasher h;
  h.bytes(sample.data(), sample.size());
  return h.value();
}

ChunkLog::ChunkLog(const RecordingLayout& layout, const ChunkPlan& plan)
    : layout_(layout), plan_(plan), path_(chunk_log_path(layout.path)) {
  file_ = open_plainly(path_, O_CREAT | O_TRUNC | O_WRONLY | O_APPEND);
  if (file_ < 0) throw_recording_error("create the recording's chunk log", errno);
  const auto head = layout_bytes(layout);
  put(bytes_, kHead, sizeof kHead);
  put<uint64_t>(bytes_, head.size());
  put(bytes_, head.data(), head.size());
  put_sum(bytes_, 0);
  try {
    write();
  } catch (...) {
    close(file_);
    throw;
  }
}

ChunkLog::~ChunkLog() {
  if (file_ >= 0) close(file_);
}

void ChunkLog::add(const std::byte* image, size_t frames) {
  const size_t begin = bytes_.size();
  put(bytes_, kRecord, sizeof kRecord);
  put<uint32_t>(bytes_, 0);
  const size_t body = bytes_.size();
  put<uint64_t>(bytes_, frames);
  for (const PlannedArray& a : plan_.arrays) {
    if (is_logged_whole(a)) {
      put(bytes_, image + a.offset, a.chunk_bytes + 4);
      continue;
    }
    const size_t used = used_chunks(layout_, plan_, image, a);
    put<uint64_t>(bytes_, used);
    for (size_t c = 0; c < used; ++c) put(bytes_, chunk_key(image + a.offset + c * a.stride, a.chunk_bytes));
  }
  const auto size = static_cast<uint32_t>(bytes_.size() - body);
  std::memcpy(bytes_.data() + begin + sizeof kRecord, &size, sizeof size);
  put_sum(bytes_, begin);
}

void ChunkLog::write() {
  // Frames in a file that has lost its name are gone with the process.
  struct stat about {};
  if (fstat(file_, &about) == 0 && about.st_nlink == 0)
    throw Error("recording_io", "the recording's file was removed while it was written");
  write_plainly(file_, bytes_, "write the recording's chunk log");
  bytes_.clear();
}

void ChunkLog::remove() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

std::optional<LoggedChunks> read_chunk_log(const std::string& recording) {
  const auto all = read_plainly(chunk_log_path(recording));
  if (!all) return std::nullopt;
  std::span<const std::byte> rest(*all);
  const auto head = take_block<uint64_t>(kHead, rest);
  if (!head) return std::nullopt;
  auto layout = layout_from_bytes(*head);
  if (!layout) return std::nullopt;
  LoggedChunks log{.layout = std::move(*layout), .plan = {}, .batches = {}};
  log.layout.path = recording;
  log.plan = plan_chunks(log.layout);
  while (const auto body = take_block<uint32_t>(kRecord, rest)) {
    auto batch = read_batch(*body, log.plan);
    if (!batch) break;
    log.frames += batch->frames;
    log.batches.push_back(std::move(*batch));
    // Only the last batch may be short.
    if (log.batches.back().frames < log.plan.frames) break;
  }
  return log;
}

}  // namespace truestep
