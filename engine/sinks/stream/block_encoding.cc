#include "engine/sinks/stream/block_encoding.h"

#include "engine/base/errors.h"
#include "engine/sinks/stream/quaternion_packing.h"
#include "engine/sinks/stream/wire_format.h"

namespace truestep {

namespace {

template <class T>
std::string_view bytes_of(const std::vector<T>& v) {
  return {reinterpret_cast<const char*>(v.data()), v.size() * sizeof(T)};
}

}  // namespace

WireEncoding plain_encoding(Scalar type) {
  switch (type) {
    case Scalar::f64:
      return WireEncoding::f64;
    case Scalar::f32:
      return WireEncoding::f32;
    case Scalar::u32:
      return WireEncoding::u32;
    case Scalar::u64:
      return WireEncoding::u64;
    case Scalar::i32:
      return WireEncoding::i32;
  }
  throw Error("internal", "a type without an encoding");
}

const FrameBlock& block_of(const Frame& frame, const WireField& field) {
  const FrameBlock* block = frame.find(field.key);
  if (!block) throw Error("internal", "the frame does not hold field " + field.name);
  return *block;
}

const float* floats_of(const FrameBlock& block) {
  return reinterpret_cast<const float*>(block.data.data());
}

void append_block(std::string& out, const WireField& field, const FrameBlock& block, WireEncoding encoding,
                  const QuantumBox& box, std::string_view data) {
  using namespace wire;
  std::string head;
  put_bytes(head, 1, field.system);
  put_bytes(head, 2, field.name);
  put_integer(head, 3, static_cast<uint64_t>(encoding));
  put_doubles(head, 4, box.offset);
  put_doubles(head, 5, box.scale);
  put_integer(head, 6, block.rows);
  put_integer(head, 7, block.width);
  const size_t data_size = data.empty() ? 0 : 1 + varint_size(data.size()) + data.size();
  put_tag(out, 9, length);
  put_varint(out, head.size() + data_size);
  out.append(head);
  put_bytes(out, 8, data);
}

void append_block(std::string& out, const WireField& field, const FrameBlock& block) {
  if (block.key.type == Scalar::f32) {
    if (field.encoding == WireEncoding::q16 || field.encoding == WireEncoding::q16_delta) {
      ColumnBounds bounds;
      std::vector<uint16_t> values(block.rows * block.width);
      if (column_bounds(floats_of(block), block.rows, block.width, bounds)) {
        const QuantumBox box = tight_box(bounds);
        quantise(floats_of(block), block.rows, block.width, box, values.data());
        return append_block(out, field, block, WireEncoding::q16, box, bytes_of(values));
      }
    } else if (field.encoding == WireEncoding::quat32 && block.width == 4) {
      std::vector<uint32_t> packed(block.rows);
      if (pack_quaternions(floats_of(block), block.rows, packed.data()))
        return append_block(out, field, block, WireEncoding::quat32, {}, bytes_of(packed));
    }
  }
  append_block(out, field, block, plain_encoding(block.key.type), {},
               {reinterpret_cast<const char*>(block.data.data()), block.data.size()});
}

}  // namespace truestep
