// Chunk logs: any bytes give a layout that plans and survives a round trip, or nothing; and a log of whole
// batches, or nothing. The checksums keep mutations from reaching the inside of a log, so the same bytes are
// also read as a layout without one, and wrapped in a log with correct checksums.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "engine/sinks/recording/file/layout_bytes.h"
#include "engine/sinks/recording/file/superblock.h"
#include "engine/sinks/recording/log/chunk_log.h"
#include "tests/fuzz/scratch_folder.h"

namespace {

using namespace truestep;

template <class Size>
void put_block(std::vector<std::byte>& to, const std::string& mark, std::span<const std::byte> body) {
  const size_t begin = to.size();
  const auto put = [&](const void* from, size_t size) {
    const auto* bytes = static_cast<const std::byte*>(from);
    to.insert(to.end(), bytes, bytes + size);
  };
  const auto size = static_cast<Size>(body.size());
  put(mark.data(), mark.size());
  put(&size, sizeof size);
  put(body.data(), body.size());
  const uint32_t sum = lookup3(to.data() + begin, to.size() - begin);
  put(&sum, sizeof sum);
}

void read(std::span<const std::byte> log) {
  const std::string path = fuzz::scratch_folder() / "input";
  std::ofstream(chunk_log_path(path), std::ios::binary)
      .write(reinterpret_cast<const char*>(log.data()), static_cast<std::streamsize>(log.size()));
  const auto chunks = read_chunk_log(path);
  if (!chunks) return;
  uint64_t frames = 0;
  for (const LoggedChunks::Batch& batch : chunks->batches) frames += batch.frames;
  if (frames != chunks->frames) __builtin_trap();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  read(bytes);
  if (size < 2) return 0;
  // The first two bytes give the end of the layout, where a batch begins.
  const auto rest = bytes.subspan(2);
  const size_t cut = std::min<size_t>(data[0] | data[1] << 8, rest.size());
  std::vector<std::byte> log;
  put_block<uint64_t>(log, "TSCHUNK1", rest.first(cut));
  put_block<uint32_t>(log, "CREC", rest.subspan(cut));
  read(log);
  const auto layout = layout_from_bytes(rest.first(cut));
  if (!layout) return 0;
  const auto again = layout_bytes(*layout);
  if (again.size() != cut || !std::equal(again.begin(), again.end(), rest.begin())) __builtin_trap();
  return 0;
}
