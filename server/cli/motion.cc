#include "server/cli/motion.h"

#include <iostream>

#include "engine/base/errors.h"
#include "engine/scene/admission.h"
#include "engine/session/describe.h"
#include "engine/sinks/motion/session_motion.h"
#include "server/cli/exit_codes.h"
#include "server/cli/input.h"
#include "server/cli/interruption.h"

namespace truestep {

namespace {

struct MotionOptions {
  std::string scene, output, system;
  double rate = 30, seconds = -1;
};

int motion(const MotionOptions& o) {
  const bool bvh = o.output.ends_with(".bvh"), glb = o.output.ends_with(".glb");
  if (!bvh && !glb && !o.output.ends_with(".gltf"))
    throw Error("unknown_format", "-o ends in .bvh, .gltf or .glb");
  const MotionFormat format = bvh ? MotionFormat::bvh : glb ? MotionFormat::glb : MotionFormat::gltf;
  Scene scene = require_scene(examine_scene(load_scene_document(o.scene), kOwnMachine));
  require_admission(estimate(scene), kOwnMachine);
  const double dt = scene.header.time.dt;
  const double seconds = o.seconds >= 0 ? o.seconds : scene.header.time.duration;
  const auto world = std::make_shared<const World>(std::move(scene));
  const size_t system = motion_system(*world, o.system, format, "--system");
  MotionExport file(world->system(system), world->id(system), o.rate);
  Session session(world, std::make_shared<const ThreadArena>(1), {.history_bytes = 0});
  note_interruptions();
  const FrameSteps steps{0, o.rate, dt};
  const uint64_t frames = steps.count(seconds);
  for (uint64_t f = 0; f < frames && !interrupted(); ++f) {
    const uint64_t step = steps.step(f);
    if (step > session.step_index() && session.step(step - session.step_index()) == 0) break;
    if (session.failure()) break;
    file.add(session.state().systems[system], session.time());
  }
  const std::string text = write_motion(file, format);
  save_bytes(o.output, std::as_bytes(std::span(text)));
  std::cout << o.output << ": " << file.frames() << " frames\n";
  if (session.failure()) {
    std::cerr << "unstable: " << session.failure()->detail << '\n';
    return kExitUnstable;
  }
  return interrupted() ? kExitInterrupted : kExitOk;
}

}  // namespace

void add_motion_command(Arguments app, int& exit_code) {
  auto options = std::make_shared<MotionOptions>();
  Arguments c = app.add_subcommand("motion", "a skeleton or blended shapes of a scene as a BVH or glTF file");
  c.add_option("scene", options->scene, "scene file, gallery name, or - for standard input").required();
  c.add_option("-o,--output", options->output, "file to write (.bvh, .gltf, .glb)").required();
  c.add_option("--system", options->system, "which system (default: the first with joints or shapes)");
  c.add_option("--rate", options->rate, "frames per second of the scene's time").in_range(0.01, 10'000.0);
  c.add_option("--seconds", options->seconds, "simulated seconds (default: the scene's duration)")
      .in_range(0.0, 1e6);
  c.callback([options, &exit_code] { exit_code = motion(*options); });
}

}  // namespace truestep
