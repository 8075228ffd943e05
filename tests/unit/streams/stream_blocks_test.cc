// Blocks as bytes: rotations within their stated angle, values that an encoding cannot represent, and bytes
// that web/test/decode.test.mjs reads too (stream_bytes.txt there).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <random>

#include "engine/session/session.h"
#include "engine/sinks/stream/quaternion_packing.h"
#include "tests/support/stream_frames.h"

namespace truestep {
namespace {

using Quaternion = std::array<double, 4>;

// Rotation that takes a to b, rad; by the sine for small angles. Signs do not matter, q and -q are one
// rotation.
double angle_between(const Quaternion& a, const float* b) {
  double dot = 0, norm = 0;
  for (int c = 0; c < 4; ++c) dot += a[c] * b[c], norm += double(b[c]) * b[c];
  double apart = 0;
  for (int c = 0; c < 4; ++c) apart += std::pow(a[c] - std::copysign(1, dot) * b[c] / std::sqrt(norm), 2);
  return 4 * std::asin(std::min(1.0, std::sqrt(apart) / 2));
}

std::vector<std::vector<double>> through_the_wire(const std::vector<WireField>& fields,
                                                  const std::vector<std::vector<float>>& values,
                                                  v1::Frame& message) {
  const FramePtr frame = stream_frame(fields, values);
  EXPECT_TRUE(
      message.ParseFromString(encode_frame_fields(*frame, {1, 0, 0}) + *encode_blocks(*frame, fields)));
  return StreamDecoder().decode(message);
}

double worst_angle(const std::vector<float>& q, const std::vector<double>& decoded) {
  double worst = 0;
  for (size_t i = 0; i < q.size(); i += 4) {
    worst =
        std::max(worst, angle_between({decoded[i], decoded[i + 1], decoded[i + 2], decoded[i + 3]}, &q[i]));
  }
  return worst;
}

// Ids of particles are 64 bits wide: as U32, every second one would be the upper half of the one before.
TEST(Blocks, IntegersComeAsTheyAre) {
  const auto world = std::make_shared<const World>(parse_scene(
      R"({"systems": [{"type": "particles", "id": "p", "positions": [[0, 0, 0], [1, 0, 0], [2, 0, 0]]}]})"));
  const Session session(world, std::make_shared<const ThreadArena>(1));
  for (const WireEncoding wish : {WireEncoding::f32, WireEncoding::q16_delta}) {
    const auto fields = wire_fields(*world, {"id"}, {}, wish);
    ASSERT_EQ(fields.size(), 1u);
    EXPECT_EQ(fields[0].encoding, WireEncoding::u64);
    const FramePtr frame = session.frame(request_for(fields, FrameRequest::Extras::none));
    EXPECT_FALSE(frame->state_hash) << "nobody asked for it";
    v1::Frame message;
    ASSERT_TRUE(
        message.ParseFromString(encode_frame_fields(*frame, {1, 0, 0}) + *encode_blocks(*frame, fields)));
    EXPECT_EQ(message.blocks(0).encoding(), v1::U64);
    EXPECT_EQ(StreamDecoder().decode(message)[0], (std::vector<double>{0, 1, 2}));
    // The control: read as U32 they are six numbers.
    message.mutable_blocks(0)->set_encoding(v1::U32);
    EXPECT_THROW(StreamDecoder().decode(message), std::runtime_error);
  }
}

TEST(Quat32, RandomRotationsStayWithinTheStatedAngle) {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  std::vector<float> q(4 * 200000);
  for (float& v : q) v = normal(random);
  v1::Frame message;
  const auto decoded = through_the_wire({stream_field(0, 4, WireEncoding::quat32)}, {q}, message);
  EXPECT_EQ(message.blocks(0).data().size(), q.size());
  EXPECT_LE(worst_angle(q, decoded[0]), kQuaternionPackingError);
  // The control: one bit less in each component doubles the error.
  auto coarse = decoded[0];
  for (double& v : coarse) v = std::round(v * 511 * std::sqrt(2.0) / 2) * 2 / (511 * std::sqrt(2.0));
  EXPECT_GT(worst_angle(q, coarse), kQuaternionPackingError);
}

TEST(Quat32, TheBoundIsReachedAroundEqualComponents) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> near(-4e-3f, 4e-3f);
  std::vector<float> q(4 * 100000);
  for (float& v : q) v = 0.5f + near(random);
  v1::Frame message;
  const auto decoded = through_the_wire({stream_field(0, 4, WireEncoding::quat32)}, {q}, message);
  const double worst = worst_angle(q, decoded[0]);
  EXPECT_LE(worst, kQuaternionPackingError);
  EXPECT_GT(worst, 0.9 * kQuaternionPackingError);
}

TEST(Quat32, QuarterTurnsAndTheIdentityAreExactAndSignsDoNotMatter) {
  const std::vector<float> q = {1, 0, 0, 0, -1, 0, 0, 0, 0, 0, -3, 0, 0, 1, 0, 0};
  v1::Frame message;
  const auto decoded = through_the_wire({stream_field(0, 4, WireEncoding::quat32)}, {q}, message)[0];
  EXPECT_EQ(decoded, (std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0}));
}

TEST(StreamBlocks, WhatAnEncodingCannotCarryTravelsAsFloats) {
  const float nan = std::nanf("");
  v1::Frame message;
  through_the_wire({stream_field(0, 4, WireEncoding::quat32), stream_field(1, 3, WireEncoding::q16),
                    stream_field(2, 4, WireEncoding::quat32)},
                   {{1, 0, 0, 0, 0, 0, 0, 0}, {1, 2, nan}, {1, 0, 0, nan}}, message);
  for (const v1::Block& block : message.blocks()) EXPECT_EQ(block.encoding(), v1::F32);
}

TEST(StreamBlocks, SyntheticFrameOfEveryEncoding) {
  v1::Frame message;
  const std::vector<float> x = {0, 1, 2, 10, 11, 12}, q = {0.6f, 0, 0.8f, 0, 0, 0, 0, 1};
  const auto decoded = through_the_wire(
      {stream_field(0, 3, WireEncoding::f32), stream_field(1, 3, WireEncoding::q16),
       stream_field(2, 3, WireEncoding::q16_delta), stream_field(3, 4, WireEncoding::quat32)},
      {x, x, x, q}, message);
  ASSERT_EQ(message.blocks_size(), 4);
  EXPECT_EQ(message.blocks(2).encoding(), v1::Q16);  // without a base
  for (const size_t k : {0, 1, 2}) {
    for (size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(decoded[k][i], x[i], 5 / 65535.0 * 1.001);
  }
  EXPECT_LE(worst_angle(q, decoded[3]), kQuaternionPackingError);
}

std::string hex(const std::string& bytes) {
  std::string out;
  char two[3];
  for (const char c : bytes)
    std::snprintf(two, sizeof two, "%02x", static_cast<unsigned char>(c)), out += two;
  return out;
}

// The counterpart of the test of the same name in web/test/decode.test.mjs.
TEST(StreamBlocks, BytesThatTheBrowserReads) {
  DeltaCoder coder({stream_field(0, 3, WireEncoding::q16_delta), stream_field(1, 4, WireEncoding::quat32)});
  const std::vector<float> q = {0.5f, -0.5f, 0.1f, 0.7f};
  std::vector<float> x(120), y(120);
  for (int k = 0; k < 120; ++k) {
    x[k] = static_cast<float>(k * 7 % 32) / 32;
    y[k] = x[k] + static_cast<float>(k % 5 - 2) / 1024;
  }
  DeltaClient client;
  std::vector<std::string> messages;
  for (const auto& values : {x, y}) {
    const auto decoded = client.receive(coder, stream_frame(coder.fields(), {values, q}));
    for (size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(decoded[0][i], values[i], 1.25 / 65535 / 2);
    messages.push_back(hex(client.message.SerializeAsString()));
  }
  EXPECT_EQ(client.message.blocks(0).encoding(), v1::Q16_DELTA);
  std::ifstream file(TRUESTEP_SOURCE_DIR "/web/test/stream_bytes.txt");
  std::vector<std::string> kept(2);
  std::getline(file, kept[0]);
  std::getline(file, kept[1]);
  EXPECT_EQ(messages, kept) << messages[0] << '\n' << messages[1];
}

}  // namespace
}  // namespace truestep
