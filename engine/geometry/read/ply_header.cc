#include "engine/geometry/read/ply_header.h"

#include <limits>

namespace truestep {

namespace {

constexpr size_t kMostSections = 100, kMostProperties = 1000;

struct TypeName {
  std::string_view name;
  PlyType type;
};
constexpr TypeName kTypeNames[] = {
    {"char", PlyType::i8},   {"uchar", PlyType::u8},   {"short", PlyType::i16},   {"ushort", PlyType::u16},
    {"int", PlyType::i32},   {"uint", PlyType::u32},   {"float", PlyType::f32},   {"double", PlyType::f64},
    {"int8", PlyType::i8},   {"uint8", PlyType::u8},   {"int16", PlyType::i16},   {"uint16", PlyType::u16},
    {"int32", PlyType::i32}, {"uint32", PlyType::u32}, {"float32", PlyType::f32}, {"float64", PlyType::f64}};

PlyType read_type(TextLines& lines) {
  const std::string_view w = lines.word();
  for (const TypeName& t : kTypeNames) {
    if (t.name == w) return t.type;
  }
  lines.fail(quoted(w) + " is not a type: use char, uchar, short, ushort, int, uint, float, double");
}

PlyFormat read_format(TextLines& lines) {
  std::string_view key;
  do {
    key = lines.next_filled() ? lines.word() : std::string_view{};
  } while (key == "comment" || key == "obj_info");
  if (key != "format") lines.fail("the second line must be \"format ascii 1.0\" or similar");
  const std::string_view name = lines.word(), version = lines.word();
  if (version != "1.0") lines.fail("version " + quoted(version) + " is not supported: use 1.0");
  if (name == "ascii") return PlyFormat::ascii;
  if (name == "binary_little_endian") return PlyFormat::binary_little_endian;
  if (name == "binary_big_endian") return PlyFormat::binary_big_endian;
  lines.fail(quoted(name) + " is not a format: use ascii, binary_little_endian or binary_big_endian");
}

PlyProperty read_property(TextLines& lines) {
  PlyProperty out;
  if (lines.peek() == "list") {
    lines.word();
    out.count = read_type(lines);
    if (*out.count == PlyType::f32 || *out.count == PlyType::f64)
      lines.fail("the type of a length must be an integer");
  }
  out.type = read_type(lines);
  out.name = lines.word();
  if (out.name.empty()) lines.fail("a property needs a name");
  return out;
}

}  // namespace

size_t size_of(PlyType type) {
  constexpr size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<size_t>(type)];
}

size_t PlyElement::least_size(PlyFormat format) const {
  size_t out = 0;
  for (const PlyProperty& p : properties) {
    // As text, a digit and its terminator.
    out += format == PlyFormat::ascii ? 2 : size_of(p.count.value_or(p.type));
  }
  return out;
}

PlyHeader read_ply_header(TextLines& lines) {
  if (!lines.next() || lines.word() != "ply") lines.fail("a PLY file begins with a line \"ply\"");
  PlyHeader out;
  out.format = read_format(lines);
  for (;;) {
    if (!lines.next_filled()) lines.fail("the file ends without end_header");
    const std::string_view key = lines.word();
    if (key == "end_header") break;
    if (key == "comment" || key == "obj_info") continue;
    if (key == "element") {
      if (out.elements.size() == kMostSections) lines.fail("more than a hundred elements");
      PlyElement e;
      e.name = lines.word();
      e.count = static_cast<size_t>(
          lines.integer("the number of elements", 0, std::numeric_limits<uint32_t>::max()));
      out.elements.push_back(std::move(e));
    } else if (key == "property") {
      if (out.elements.empty()) lines.fail("a property must come after its element");
      auto& properties = out.elements.back().properties;
      if (properties.size() == kMostProperties) lines.fail("more than a thousand properties");
      properties.push_back(read_property(lines));
    } else {
      lines.fail(quoted(key) + " is not a line of a header: use element, property, comment or end_header");
    }
  }
  size_t least = 0;
  for (const PlyElement& e : out.elements) {
    if (e.name == "vertex" && e.count > kMostFileVertices)
      lines.fail("more than " + std::to_string(kMostFileVertices) + " vertices are announced");
    if (e.properties.empty() && e.count > 0) lines.fail("element " + quoted(e.name) + " has no properties");
    least += e.count * e.least_size(out.format);
  }
  // The last word of a text needs no terminator.
  if (least > lines.text_after().size() + 1) {
    lines.fail("the header announces " + std::to_string(least) + " bytes or more, and " +
               std::to_string(lines.text_after().size()) + " follow");
  }
  return out;
}

}  // namespace truestep
