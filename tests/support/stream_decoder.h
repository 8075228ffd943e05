// Decodes a stream's frames from their bytes, as a client does: the message by the generated parser, the
// arrays by loops written from stream.proto alone, so that they share nothing with the encoder.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "truestep/v1/stream.pb.h"

namespace truestep {

/// One client's decoder: keeps the values that Q16_DELTA blocks refer to. Throws std::runtime_error for
/// inconsistent bytes.
class StreamDecoder {
 public:
  /// The values of every block in order.
  std::vector<std::vector<double>> decode(const v1::Frame& frame) {
    if (frame.base_seq() != 0 && frame.base_seq() != seq_)
      throw std::runtime_error("not the frame that came last");
    std::vector<std::vector<double>> out;
    for (const v1::Block& block : frame.blocks()) out.push_back(values_of(block));
    seq_ = frame.seq();
    return out;
  }

  /// Pretends that the frame with this number arrived, for a control.
  void skip_to(uint64_t seq) { seq_ = seq; }

 private:
  template <class T>
  static std::vector<T> array(const std::string& bytes) {
    if (bytes.size() % sizeof(T)) throw std::runtime_error("torn array");
    std::vector<T> v(bytes.size() / sizeof(T));
    if (!v.empty()) std::memcpy(v.data(), bytes.data(), bytes.size());
    return v;
  }

  std::vector<double> values_of(const v1::Block& block) {
    const size_t n = size_t{block.count()} * block.width();
    std::vector<double> out;
    std::vector<uint16_t>& held = held_[{block.system(), block.field()}];
    switch (block.encoding()) {
      case v1::F32:
        for (const float v : array<float>(block.data())) out.push_back(v);
        break;
      case v1::F64:
        out = array<double>(block.data());
        break;
      case v1::Q16:
        held = array<uint16_t>(block.data());
        out = scaled(block, held);
        break;
      case v1::Q16_DELTA:
        held.resize(n);
        add_differences(array<uint8_t>(block.data()), held);
        out = scaled(block, held);
        break;
      case v1::QUAT32:
        for (const uint32_t packed : array<uint32_t>(block.data())) append_quaternion(packed, out);
        break;
      case v1::U32:
        for (const uint32_t v : array<uint32_t>(block.data())) out.push_back(v);
        break;
      case v1::U64:
        for (const uint64_t v : array<uint64_t>(block.data())) out.push_back(static_cast<double>(v));
        break;
      case v1::I32:
        for (const int32_t v : array<int32_t>(block.data())) out.push_back(v);
        break;
      default:
        throw std::runtime_error("unknown encoding");
    }
    if (out.size() != n) throw std::runtime_error("not count x width values");
    return out;
  }

  static std::vector<double> scaled(const v1::Block& block, const std::vector<uint16_t>& q) {
    const auto width = static_cast<int>(block.width());
    if (block.offset_size() != width || block.scale_size() != width) throw std::runtime_error("no box");
    std::vector<double> out;
    for (size_t i = 0; i < q.size(); ++i) {
      const int c = static_cast<int>(i) % width;
      out.push_back(block.offset(c) + block.scale(c) * q[i]);
    }
    return out;
  }

  // One bit at a time.
  static void add_differences(const std::vector<uint8_t>& data, std::vector<uint16_t>& values) {
    const size_t groups = (values.size() + 255) / 256;
    size_t at = (groups + 3) / 4 * 4;
    for (size_t g = 0; g < groups; ++g) {
      const size_t bits = data.at(g), count = std::min<size_t>(256, values.size() - 256 * g);
      const size_t words = (bits * ((count + 15) / 16) + 15) / 16;
      for (size_t k = 0; k < count; ++k) {
        uint32_t z = 0;
        for (size_t b = 0; b < bits; ++b) {
          const size_t bit = k / 16 * bits + b, byte = at + 2 * (bit / 16 * 16 + k % 16) + bit % 16 / 8;
          z |= (data.at(byte) >> bit % 8 & 1u) << b;
        }
        const uint32_t d = z & 1 ? ~(z >> 1) : z >> 1;
        values[256 * g + k] = static_cast<uint16_t>(values[256 * g + k] + d);
      }
      at += 32 * words;
    }
    if (at != data.size()) throw std::runtime_error("bytes left over");
  }

  static void append_quaternion(uint32_t packed, std::vector<double>& out) {
    double sum = 0, q[4];
    int shift = 20;
    const uint32_t largest = packed >> 30;
    for (uint32_t c = 0; c < 4; ++c) {
      if (c == largest) continue;
      q[c] = (static_cast<double>(packed >> shift & 1023) - 511) / (511 * std::sqrt(2.0));
      sum += q[c] * q[c];
      shift -= 10;
    }
    q[largest] = std::sqrt(std::max(0.0, 1 - sum));
    out.insert(out.end(), q, q + 4);
  }

  uint64_t seq_ = 0;
  std::map<std::pair<std::string, std::string>, std::vector<uint16_t>> held_;
};

}  // namespace truestep
