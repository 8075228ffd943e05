// Q16_DELTA streams: every client decodes every frame that it received within half a quantum, whatever it
// missed.
#include "engine/sinks/stream/delta_coder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/stream_frames.h"

namespace truestep {
namespace {

const std::vector<WireField> kFields = {stream_field(0, 3, WireEncoding::q16_delta),
                                        stream_field(1, 1, WireEncoding::q16_delta)};

// Points that drift and oscillate; `spread` multiplies their motion per frame.
struct Walk {
  std::mt19937 random{5};
  std::vector<float> x, s;

  explicit Walk(size_t rows) : x(3 * rows), s(rows) {
    std::uniform_real_distribution<float> in(-1, 1);
    for (float& v : x) v = in(random);
    for (float& v : s) v = in(random);
  }
  FramePtr next(float spread) {
    std::normal_distribution<float> by(0, spread);
    for (float& v : x) v += by(random);
    for (float& v : s) v += by(random);
    return stream_frame(kFields, {x, s});
  }
};

// Largest error in quanta over the frame's blocks.
double worst_error(const Frame& frame, const DeltaClient& client,
                   const std::vector<std::vector<double>>& decoded) {
  double worst = 0;
  for (size_t k = 0; k < decoded.size(); ++k) {
    const auto* v = reinterpret_cast<const float*>(frame.blocks[k].data.data());
    const v1::Block& block = client.message.blocks(static_cast<int>(k));
    for (size_t i = 0; i < decoded[k].size(); ++i) {
      worst =
          std::max(worst, std::abs(decoded[k][i] - v[i]) / block.scale(static_cast<int>(i % block.width())));
    }
  }
  return worst;
}

constexpr double kBound = 0.5 + 0x1p-26;  // quanta; the rest is what doubles round

TEST(DeltaCoder, ErrorsDoNotAddUpForAnyClient) {
  DeltaCoder coder(kFields);
  DeltaClient every, third, seldom, forgetful;
  Walk walk(300);
  size_t small = 0, keys = 0;
  double missed = 0;
  for (int n = 0; n < 700; ++n) {
    const FramePtr frame = walk.next(0.002f);
    const auto got = every.receive(coder, frame);
    EXPECT_LE(worst_error(*frame, every, got), kBound);
    if (every.message.keyframe()) ++keys;
    small += every.message.ByteSizeLong() < 300 * 4 * 1.5;
    if (n % 3 == 0) {
      EXPECT_LE(worst_error(*frame, third, third.receive(coder, frame)), kBound);
    }
    if (walk.random() % 20 == 0) {
      EXPECT_LE(worst_error(*frame, seldom, seldom.receive(coder, frame)), kBound);
    }
    // The control: a client recorded as having a frame that it never decoded.
    DeltaClient truth = forgetful;
    const auto wrong = forgetful.receive(coder, frame);
    if (n % 7 == 3) forgetful.decoder = truth.decoder, forgetful.decoder.skip_to(forgetful.seq);
    missed = std::max(missed, worst_error(*frame, forgetful, wrong));
  }
  EXPECT_GT(missed, 10);
  EXPECT_GT(small, 600u);  // differences of that walk take 8 to 10 bits of 16
  EXPECT_GE(keys, 3u);     // the first, and one each kBoxFrames
  EXPECT_LE(keys, 20u);
}

TEST(DeltaCoder, LeavingTheBoxIsAKeyFrameWithARoomierBox) {
  DeltaCoder coder(kFields);
  DeltaClient client;
  Walk walk(40);
  client.receive(coder, walk.next(0));
  const double before = client.message.blocks(0).scale(0);
  client.receive(coder, walk.next(1e-3f));
  EXPECT_FALSE(client.message.keyframe());
  walk.x[9] += 100;
  const FramePtr far = walk.next(0);
  EXPECT_LE(worst_error(*far, client, client.receive(coder, far)), kBound);
  EXPECT_TRUE(client.message.keyframe());
  EXPECT_GT(client.message.blocks(0).scale(0), 10 * before);
  // Back again: the box still contains both positions.
  walk.x[9] -= 100;
  client.receive(coder, walk.next(0));
  EXPECT_FALSE(client.message.keyframe());
}

TEST(DeltaCoder, RowsComeAndGo) {
  DeltaCoder coder(kFields);
  DeltaClient client;
  Walk walk(500);
  client.receive(coder, walk.next(0));
  for (const size_t rows : {500u, 511u, 40u, 0u, 1u, 86u, 5u, 1000u}) {
    walk.x.resize(3 * rows, 0.25f);
    walk.s.resize(rows, 0.25f);
    const FramePtr frame = walk.next(1e-3f);
    const auto got = client.receive(coder, frame);
    ASSERT_EQ(got[0].size(), 3 * rows);
    EXPECT_LE(worst_error(*frame, client, got), kBound) << rows;
  }
}

TEST(DeltaCoder, ValuesThatAreNotFiniteTravelAsTheyAre) {
  DeltaCoder coder(kFields);
  DeltaClient client;
  Walk walk(20);
  client.receive(coder, walk.next(0));
  const float kept = walk.x[7];
  walk.x[7] = INFINITY;
  const auto got = client.receive(coder, walk.next(0));
  EXPECT_EQ(client.message.blocks(0).encoding(), v1::F32);
  EXPECT_EQ(got[0][7], INFINITY);
  walk.x[7] = kept;
  const FramePtr frame = walk.next(0);
  EXPECT_LE(worst_error(*frame, client, client.receive(coder, frame)), kBound);
  EXPECT_TRUE(client.message.keyframe());
}

TEST(DeltaCoder, ClientsThatHoldTheSameShareTheBytes) {
  DeltaCoder coder(kFields);
  Walk walk(20);
  const EncodedBlocks first = coder.encode(walk.next(0), nullptr);
  const FramePtr frame = walk.next(1e-3f);
  const EncodedBlocks a = coder.encode(frame, first.held), b = coder.encode(frame, first.held);
  const EncodedBlocks key = coder.encode(frame, nullptr);
  EXPECT_EQ(a.bytes, b.bytes);
  EXPECT_NE(a.bytes, key.bytes);
  EXPECT_EQ(a.held, key.held);
  EXPECT_EQ(key.kind, EncodedBlocks::Kind::key);
  EXPECT_EQ(a.kind, EncodedBlocks::Kind::refers_to_base);
}

}  // namespace
}  // namespace truestep
