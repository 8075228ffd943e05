#include "engine/sinks/recording/log/chunk_search.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <unordered_map>

#include "engine/base/errors.h"
#include "engine/sinks/recording/file/fletcher32.h"
#include "engine/sinks/recording/file/plain_file.h"
#include "engine/sinks/recording/file/recording_file.h"

namespace truestep {
namespace {

constexpr size_t kPage = 4096;

/// A file's bytes, read only.
class MappedFile {
 public:
  explicit MappedFile(const std::string& path) {
    const int file = open_plainly(path, O_RDONLY);
    struct stat s {};
    if (file >= 0 && fstat(file, &s) == 0 && s.st_size > 0) {
      void* at = mmap(nullptr, static_cast<size_t>(s.st_size), PROT_READ, MAP_PRIVATE, file, 0);
      if (at != MAP_FAILED) bytes_ = {static_cast<const std::byte*>(at), static_cast<size_t>(s.st_size)};
    }
    if (file >= 0) close(file);
  }
  ~MappedFile() {
    if (!bytes_.empty()) munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
  }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

bool has_checksum(const std::byte* chunk, size_t size) {
  uint32_t sum;
  std::memcpy(&sum, chunk + size, sizeof sum);
  return sum == fletcher32(chunk, size);
}

/// Locations of the chunks of one size. Chunks with the same key are identical, so one location is enough.
class Places {
 public:
  explicit Places(size_t size) : size_(size) {}
  size_t size() const { return size_; }
  void want(uint64_t key) { at_.emplace(key, nullptr); }
  void look_at(std::span<const std::byte> here) {
    if (here.size() < size_ + 4) return;
    const auto found = at_.find(chunk_key(here.data(), size_));
    if (found == at_.end() || found->second || !has_checksum(here.data(), size_)) return;
    found->second = here.data();
  }
  const std::byte* find(uint64_t key) const { return at_.at(key); }

 private:
  size_t size_;
  std::unordered_map<uint64_t, const std::byte*> at_;
};

class Search {
 public:
  Search(const LoggedChunks& log, std::span<const std::byte> file) {
    for (const PlannedArray& a : log.plan.arrays) {
      if (!is_logged_whole(a)) arrays_.push_back(&places(a.chunk_bytes) - places_.data());
    }
    for (const LoggedChunks::Batch& b : log.batches) {
      for (size_t k = 0; k < arrays_.size(); ++k) {
        for (const uint64_t key : b.keys[k]) places_[arrays_[k]].want(key);
      }
    }
    for (size_t at = 0; at < file.size(); at += kPage) {
      for (Places& p : places_) p.look_at(file.subspan(at));
    }
  }

  /// The batch as it was passed to the file, or false when a chunk is missing or damaged.
  bool restore(const LoggedChunks& log, const LoggedChunks::Batch& batch, std::byte* image) const {
    const ChunkPlan& plan = log.plan;
    const std::byte* whole = batch.whole.data();
    size_t k = 0;
    for (const PlannedArray& a : plan.arrays) {
      const size_t size = a.chunk_bytes + 4;
      std::byte* to = image + a.offset;
      if (is_logged_whole(a)) {
        std::memcpy(to, whole, size);
        whole += size;
        if (!has_checksum(to, a.chunk_bytes)) return false;
        continue;
      }
      for (const uint64_t key : batch.keys[k]) {
        const std::byte* chunk = places_[arrays_[k]].find(key);
        if (!chunk) return false;
        std::memcpy(to, chunk, size);
        to += a.stride;
      }
      ++k;
    }
    return keys_fit_rows(log, batch, image);
  }

 private:
  // As many chunks as the row counts in the image require.
  static bool keys_fit_rows(const LoggedChunks& log, const LoggedChunks::Batch& batch,
                            const std::byte* image) {
    size_t k = 0;
    for (const PlannedArray& a : log.plan.arrays) {
      if (is_logged_whole(a)) continue;
      if (batch.keys[k++].size() != used_chunks(log.layout, log.plan, image, a)) return false;
    }
    return true;
  }
  Places& places(size_t size) {
    const auto same = std::ranges::find(places_, size, &Places::size);
    return same != places_.end() ? *same : places_.emplace_back(size);
  }

  std::vector<Places> places_;
  std::vector<std::ptrdiff_t> arrays_;  // for each array that is not logged verbatim: index in places_
};

}  // namespace

uint64_t rebuild_from_log(const LoggedChunks& log, const std::string& damaged, const std::string& fresh) {
  const MappedFile file(damaged);
  const Search search(log, file.bytes());
  RecordingLayout layout = log.layout;
  layout.path = fresh;
  RecordingFile out(layout, log.plan);
  std::vector<std::byte> image(log.plan.bytes);
  for (const LoggedChunks::Batch& batch : log.batches) {
    if (!search.restore(log, batch, image.data())) break;
    out.write(image.data(), batch.frames);
    out.flush();
  }
  out.finalize("");
  return out.written_frames();
}

}  // namespace truestep
