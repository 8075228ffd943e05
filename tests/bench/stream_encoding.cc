// 100,000 particles as stream blocks, each encoding beside F32, which is a plain copy: time and bytes per
// frame. The particles move at 1 m/s in a box of 3 m, at 60 frames/s.
#include <cstdio>
#include <cstring>
#include <random>

#include "engine/sinks/stream/delta_coder.h"
#include "tests/bench/report.h"

using namespace truestep;

namespace {

constexpr size_t kRows = 100000;
constexpr int kFrames = 24;

std::vector<WireField> fields(WireEncoding encoding, uint32_t width) {
  return {{{0, 0, Scalar::f32}, encoding, "a", "field", "", width}};
}

FramePtr frame_of(const std::vector<float>& values, uint32_t width) {
  auto frame = std::make_shared<Frame>();
  FrameBlock& block = frame->blocks.emplace_back();
  block.key = {0, 0, Scalar::f32};
  block.width = width;
  block.rows = values.size() / width;
  block.data.resize(4 * values.size());
  std::memcpy(block.data.data(), values.data(), block.data.size());
  return frame;
}

std::vector<FramePtr> flight(uint32_t width) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(-1.5f, 1.5f);
  std::normal_distribution<float> way(0, 1.f / 60 / 1.7f);
  std::vector<float> x(kRows * width), v(x.size());
  for (float& c : x) c = place(random);
  for (float& c : v) c = way(random);
  std::vector<FramePtr> frames;
  for (int n = 0; n < kFrames; ++n) {
    for (size_t k = 0; k < x.size(); ++k) x[k] += v[k];
    frames.push_back(frame_of(x, width));
  }
  return frames;
}

// Encodes the frames in turn, `encode(frame)` returning the bytes of one, beside F32 of the same frames.
template <class Encode>
void compare(const char* name, const std::vector<FramePtr>& frames, uint32_t width, Encode encode) {
  const auto plain = fields(WireEncoding::f32, width);
  size_t ours = 0, peer = 0;
  int turn = 0;
  const auto times = bench::interleaved(
      101, [&] { ours = encode(frames[turn % kFrames]); },
      [&] { peer = encode_blocks(*frames[turn++ % kFrames], plain)->size(); });
  const double input = 4.0 * kRows * width;
  bench::report({.bench = "stream_encoding",
                 .metric = std::string("seconds per frame of 100,000 rows as ") + name,
                 .ours = times.ours,
                 .peer = times.peer,
                 .peer_name = "F32, one copy",
                 .error_ours = {},
                 .error_peer = {}});
  bench::report({.bench = "stream_encoding",
                 .metric = std::string("bytes per frame of 100,000 rows as ") + name,
                 .ours = static_cast<double>(ours),
                 .peer = static_cast<double>(peer),
                 .peer_name = "F32",
                 .error_ours = {},
                 .error_peer = {}});
  std::fprintf(stderr, "%s: %.0f MB/s of input\n", name, input / times.ours / 1e6);
}

}  // namespace

int main() {
  const auto points = flight(3), turns = flight(4);
  compare("Q16", points, 3,
          [](const FramePtr& f) { return encode_blocks(*f, fields(WireEncoding::q16, 3))->size(); });
  DeltaCoder coder(fields(WireEncoding::q16_delta, 3));
  QuantisedFramePtr base;
  compare("Q16_DELTA", points, 3, [&](const FramePtr& f) {
    const EncodedBlocks blocks = coder.encode(f, base);
    base = blocks.held;
    return blocks.bytes->size();
  });
  compare("QUAT32", turns, 4,
          [](const FramePtr& f) { return encode_blocks(*f, fields(WireEncoding::quat32, 4))->size(); });
}
