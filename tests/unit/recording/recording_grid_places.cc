// Grids of fewer than three axes lie where their scene puts them, along the axes that they lack, too: in the
// part, in the recorded image and in an exported one.
#include <fstream>

#include "engine/scene/json/json.h"
#include "engine/session/session.h"
#include "engine/sinks/recording/export/export.h"
#include "engine/sinks/recording/file/h5.h"
#include "engine/sinks/recording/recording_sink.h"
#include "tests/unit/recording/recording_test.h"

namespace truestep::fixture {
namespace {

struct Placed {
  const char* name;
  const char* system;    ///< without its origin
  Vec3 corner_to_first;  ///< m, of the first row
  bool cells;
};
const Placed kPlaced[] = {
    {"heat_plane", R"("type": "heat", "cells": [8, 4], "size": [4, 2])", {0, 0, 0}, false},
    {"heat_line", R"("type": "heat", "cells": [8], "size": [4])", {0, 0, 0}, false},
    {"wave_plane", R"("type": "wave", "cells": [8, 4], "size": [4, 2])", {0, 0, 0}, false},
    {"flow", R"("type": "grid_fluid", "cells": [8, 4], "size": [4, 2])", {0.25, 0.25, 0}, true},
    {"pool",
     R"("type": "heightfield_wave", "cells": [8, 4], "size": [4, 2], "surface": "1")",
     {0.25, 0.25, 0},
     true},
    {"channel",
     R"("type": "heightfield_wave", "cells": [8], "size": [4], "surface": "1")",
     {0.25, 0, 0},
     true}};

class GridPlaces : public RecordingTest, public ::testing::WithParamInterface<Placed> {
 protected:
  std::shared_ptr<const World> world(const std::string& origin) const {
    return std::make_shared<const World>(parse_scene(R"({"time": {"dt": 0.001}, "systems": [{"id": "g", )" +
                                                     std::string(GetParam().system) + origin + "}]}"));
  }
  /// The file's image: where VTK draws the first node.
  Vec3 image_corner(const std::string& file) {
    double corner[3] = {};
    thread->run([&] {
      const H5 f = h5_id(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open the recording");
      const H5 image = h5_id(H5Gopen2(f, "/VTKHDF", H5P_DEFAULT), "open the image");
      const H5 origin = h5_id(H5Aopen(image, "Origin", H5P_DEFAULT), "open the origin");
      h5_ok(H5Aread(origin, H5T_NATIVE_DOUBLE, corner), "read the origin");
    });
    return {corner[0], corner[1], corner[2]};
  }
};
INSTANTIATE_TEST_SUITE_P(Of, GridPlaces, ::testing::ValuesIn(kPlaced),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(GridPlaces, AreKeptAlongMissingAxes) {
  const auto placed = world(R"(, "origin": [1, 2, 3])"), control = world("");
  const Vec3 corner{1, 2, 3};
  EXPECT_EQ(placed->parts()[0].info().lattice.origin, corner + GetParam().corner_to_first);
  EXPECT_EQ(control->parts()[0].info().lattice.origin, GetParam().corner_to_first);
  Session session(placed, std::make_shared<const ThreadArena>(1));
  {
    const auto sink = std::make_shared<RecordingSink>(thread, session, path("a.vtkhdf"));
    session.add_sink(sink);
    session.step(1);
    sink->finish();
  }
  // Images of cells begin at the corner, those of nodes at the first node: both are the scene's corner.
  EXPECT_EQ(image_corner(path("a.vtkhdf")), corner);
  RecordingReader reader(thread, path("a.vtkhdf"));
  EXPECT_EQ(reader.info().layout.parts[0].lattice.origin, corner + GetParam().corner_to_first);
  const auto files = export_recording(reader, {ExportFormat::kVti, path("out"), {}, 0, 0, 1});
  std::ifstream exported(files.at(0), std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(exported), {}};
  EXPECT_NE(text.find(R"(Origin="1 2 3")"), std::string::npos) << text.substr(0, 400);
}

TEST(LiquidPlaces, ParticlesOfAPlaneLieInIt) {
  const World world(parse_scene(R"({"time": {"dt": 0.001}, "systems": [{"type": "grid_fluid", "id": "l",
    "advection": "flip", "cells": [8, 8], "origin": [1, 2, 3],
    "bodies": [{"center": [1.5, 2.5, 0], "half_extents": [0.25, 0.25, 1]}]}]})"));
  const State start = world.system(0).initial_state();
  const auto x = start.f64(start.at("position"));
  ASSERT_GT(x.size(), 0u);
  for (size_t i = 2; i < x.size(); i += 3) ASSERT_EQ(x[i], 3) << i;
}

}  // namespace
}  // namespace truestep::fixture
