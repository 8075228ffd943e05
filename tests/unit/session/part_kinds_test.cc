// For each kind of part, a system known only to tests: it streams, records, draws, is probed and restored
// without a line about it anywhere else.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "engine/scene/json/json.h"
#include "engine/session/session.h"
#include "engine/sinks/picture/draw/draw_world.h"
#include "engine/sinks/picture/picture.h"
#include "engine/sinks/recording/export/export.h"
#include "engine/sinks/recording/recording_sink.h"
#include "engine/sinks/stream/frame_encoding.h"
#include "tests/support/part_systems.h"

namespace truestep {
namespace {

using testing::grid_part;
using testing::points_part;
using testing::values_part;
using testing::world_of_part;

struct Kind {
  const char* name;
  PartInfo (*part)();
  const char* probe;  ///< of row 2, or of the grid point there
  double at_start;    ///< of the first field there
  size_t shown;       ///< fields that a stream gets unless it names some
};
constexpr Kind kKinds[] = {
    {"points", points_part, R"({"id": "t", "system": "p", "index": 2, "fields": ["where"]})", 6, 1},
    // Halfway between rows 2 and 3 of the first line.
    {"grid", grid_part, R"({"id": "t", "system": "p", "at": [2.25, 2, 0], "fields": ["heat"]})", 2.5, 1},
    {"values", values_part, R"({"id": "t", "system": "p", "index": 2, "fields": ["load"]})", 2, 0}};

class PartKinds : public ::testing::TestWithParam<Kind> {
 protected:
  std::shared_ptr<const World> world =
      world_of_part(GetParam().part, std::string(R"("probes": [)") + GetParam().probe + "], ");
  Session session{world, std::make_shared<const ThreadArena>(1)};
  const PartInfo& part = world->parts()[0].info();
};
INSTANTIATE_TEST_SUITE_P(Of, PartKinds, ::testing::ValuesIn(kKinds),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(PartKinds, Streams) {
  session.step(3);
  EXPECT_EQ(wire_fields(*world, {}, {}, WireEncoding::f32).size(), GetParam().shown);
  const auto fields = wire_fields(*world, {part.fields[0].name}, {"p"}, WireEncoding::f64);
  ASSERT_EQ(fields.size(), 1u);
  const FramePtr frame = session.frame(request_for(fields, FrameRequest::Extras::none));
  const auto json = parse_json(encode_json(*frame, fields)).as_object();
  const auto& block = json.at("blocks").as_array().at(0).as_object();
  EXPECT_EQ(block.at("system").as_string(), "p");
  EXPECT_EQ(block.at("count").to_number<size_t>(), part.max_rows);
  const auto& first = block.at("values").as_array().at(0);
  EXPECT_EQ(first.is_array() ? first.as_array()[0].to_number<double>() : first.to_number<double>(), 3);
  EXPECT_THROW(wire_fields(*world, {"nothing"}, {}, WireEncoding::f32), Error);
  EXPECT_THROW(wire_fields(*world, {}, {"p.nothing"}, WireEncoding::f32), Error);
}

TEST_P(PartKinds, IsRecordedAndReadBack) {
  const auto folder = std::filesystem::temp_directory_path() / ("part_" + std::string(GetParam().name));
  std::filesystem::create_directories(folder);
  const std::string path = folder / "a.vtkhdf";
  auto thread = std::make_shared<RecordingThread>();
  {
    auto sink = std::make_shared<RecordingSink>(thread, session, path);
    session.add_sink(sink);
    session.step(10);
    sink->finish();
  }
  RecordingReader reader(thread, path);
  ASSERT_EQ(reader.info().frames, 11u);
  ASSERT_EQ(reader.info().layout.parts.size(), 1u);
  const RecordedPart& got = reader.info().layout.parts[0];
  EXPECT_EQ(got.id, "p");
  EXPECT_EQ(got.kind, part.kind);
  EXPECT_EQ(got.lattice, part.lattice);
  EXPECT_EQ(got.fields[0].meaning, part.fields[0].meaning);
  RecordedFrame frame;
  reader.read(10, frame);
  ASSERT_EQ(frame.systems[0].rows, part.max_rows);
  EXPECT_EQ(frame.systems[0].fields[0][0], 10);
  EXPECT_EQ(frame.systems[0].fields[0].back(),
            10 + static_cast<double>(part.max_rows * part.fields[0].width - 1));
  // Images for grids, unstructured grids for points.
  const bool grid = part.kind == PartInfo::Kind::grid;
  const auto files = [&](ExportFormat format) {
    return export_recording(reader, {format, (folder / "out").string(), {}, 0, 2, 1}).size();
  };
  EXPECT_EQ(files(ExportFormat::kVti), grid ? 4u : 1u);  // and the .pvd
  EXPECT_EQ(files(ExportFormat::kVtu), part.kind == PartInfo::Kind::points ? 4u : 1u);
  std::filesystem::remove_all(folder);
}

TEST_P(PartKinds, IsDrawn) {
  const FramePtr frame = session.frame(picture_request(*world));
  const DrawList list = draw_list_of(*world, *frame);
  const bool values = part.kind == PartInfo::Kind::values;
  EXPECT_EQ(list.points.empty(), values);
  PictureRenderer renderer(96, 96);
  const auto pixels = renderer.render_rgba(list);
  std::set<uint32_t> colors;
  for (size_t k = 0; k < pixels.size(); k += 4)
    colors.insert(uint32_t{pixels[k]} << 16 | uint32_t{pixels[k + 1]} << 8 | pixels[k + 2]);
  // The control: values alone give a caption on the background.
  const size_t many = 400;
  EXPECT_EQ(colors.size() > many, !values) << colors.size();
}

TEST_P(PartKinds, IsProbed) {
  const std::string name = "t." + part.fields[0].name + (part.fields[0].width == 3 ? ".x" : "");
  EXPECT_EQ(session.observe().find(name).value_or(-1), GetParam().at_start);
  session.step(4);
  EXPECT_EQ(session.observe().find(name).value_or(-1), GetParam().at_start + 4);
}

TEST_P(PartKinds, IsRestored) {
  session.step(5);
  const auto bytes = session.state().serialize();
  session.step(7);
  const uint64_t end = session.hash();
  Session other(world, std::make_shared<const ThreadArena>(1));
  other.restore(WorldState::deserialize(bytes));
  other.step(7);
  EXPECT_EQ(other.hash(), end);
  other.step(1);
  EXPECT_NE(other.hash(), end);  // control
}

TEST(PartNames, ProbesOutsideAGridAndPlacesInNoGridAreRefused) {
  const auto fault = [](PartInfo (*part)(), const char* probe) {
    try {
      world_of_part(part, std::string(R"("probes": [)") + probe + "], ");
    } catch (const Error& e) {
      return e.issues().empty() ? e.code() : e.issues()[0].pointer + " " + e.issues()[0].code;
    }
    return std::string();
  };
  EXPECT_EQ(fault(grid_part, R"({"id": "t", "system": "p", "at": [9, 2, 0], "fields": ["heat"]})"),
            "/probes/0/at out_of_range");
  EXPECT_EQ(fault(points_part, R"({"id": "t", "system": "p", "at": [0, 0, 0], "fields": ["mass"]})"),
            "/probes/0/at inconsistent");
  EXPECT_EQ(fault(points_part, R"({"id": "t", "system": "p.skin", "fields": ["mass"]})"),
            "/probes/0/system unknown_part");
  EXPECT_EQ(fault(points_part, R"({"id": "t", "system": "p", "fields": ["mass"]})"), "") << "the control";
}

TEST(PartNames, PartsOfASystemAreNamedAfterIt) {
  const World world(parse_scene(R"({"systems": [{"type": "mass_spring", "id": "rope",
    "rope": {"from": [0, 0, 0], "to": [1, 0, 0], "links": 4}}],
    "probes": [{"id": "a", "system": "rope.springs", "index": 3, "fields": ["strain"]}]})"));
  EXPECT_EQ(world.parts().ids(), (std::vector<std::string>{"rope", "rope.springs"}));
  EXPECT_EQ(wire_fields(world, {"strain"}, {}, WireEncoding::f32).size(), 2u);
  EXPECT_EQ(wire_fields(world, {"strain"}, {"rope.springs"}, WireEncoding::f32).size(), 1u);
  EXPECT_NEAR(world.observe(world.initial_state()).find("a.strain").value(), 0, 1e-12);
}

}  // namespace
}  // namespace truestep
