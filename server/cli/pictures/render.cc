#include "server/cli/pictures/render.h"

#include <cmath>
#include <iostream>

#include "engine/base/errors.h"
#include "engine/sinks/picture/camera.h"
#include "engine/sinks/picture/picture.h"
#include "server/cli/exit_codes.h"
#include "server/cli/input.h"
#include "server/cli/interruption.h"
#include "server/cli/pictures/movie.h"
#include "server/cli/pictures/picture_options.h"
#include "server/cli/pictures/picture_source.h"
#include "server/cli/progress.h"

namespace truestep {

namespace {

struct RenderOptions {
  std::string source, output, progress = "auto";
  PictureOptions picture;
  double per_second = 30, speed = 1;
  std::optional<double> at, from, to;
  int threads = 0;
};

constexpr int kLooks = 12;  // samples of the run, for a camera that frames all of it

// One camera for the whole film, framing what is visible at several moments. The run is then started over.
DrawCamera steady_camera(PictureSource& source, const RenderOptions& o, double from, double to,
                         PictureSize size) {
  DrawList all = source.at(from);
  for (int k = 1; k < kLooks && !interrupted(); ++k) {
    DrawList more = source.at(from + (to - from) * k / (kLooks - 1));
    all.points.insert(all.points.end(), more.points.begin(), more.points.end());
    all.shapes.insert(all.shapes.end(), more.shapes.begin(), more.shapes.end());
  }
  aim(o.picture, all);
  return picture::camera_for(all, static_cast<double>(size.width) / size.height);
}

// What cut the run short, and when the last picture is of; the exit code.
int report_failure(const PictureSource& source) {
  const auto why = source.failure();
  if (!why) return kExitOk;
  std::cerr << "unstable: " << why->why << "\nthe last picture shows t = " << why->time << " s\n";
  return kExitUnstable;
}

int render_one(PictureSource& source, const RenderOptions& o, PictureSize size) {
  PictureRenderer renderer(size.width, size.height);
  DrawList list = source.at(*o.at);
  aim(o.picture, list);
  write_png(o.output, renderer.render_rgba(list), size);
  std::cout << o.output << '\n';
  return report_failure(source);
}

int render(const RenderOptions& o) {
  const PictureSize size = picture_size(o.picture);
  DrawList unused;
  aim(o.picture, unused);  // reports errors before anything is computed
  if (o.at && !o.output.ends_with(".png"))
    throw Error("bad_request", "--at makes one picture: -o must end in .png");
  // Before the source: without a writable output there is no point in simulating.
  const auto files = o.at ? nullptr : open_pictures(o.output, size, o.per_second);
  const auto source = open_source(o.source, picture_look(o.picture), o.threads);
  const double from = o.from.value_or(source->begin());
  const double to = std::max(from, o.to.value_or(source->end()));
  note_interruptions();
  if (o.at) return render_one(*source, o, size);

  PictureRenderer renderer(size.width, size.height);
  const double spacing = o.speed / o.per_second;
  const auto count = static_cast<uint64_t>(std::floor((to - from) / spacing + 1e-9)) + 1;
  Progress progress(progress_style(o.progress), count);
  std::optional<DrawCamera> camera;
  DrawList first = source->at(from);
  aim(o.picture, first);
  if (!first.camera && count > 1) camera = steady_camera(*source, o, from, to, size);
  for (uint64_t k = 0; k < count && !interrupted(); ++k) {
    DrawList list = source->at(from + spacing * static_cast<double>(k));
    aim(o.picture, list);
    if (camera) list.camera = camera;
    files->add(renderer.render_rgba(list));
    if (source->failure()) break;
    progress.update(k + 1, "");
  }
  progress.finish();
  files->finish();
  std::cout << files->summary() << '\n';
  const int code = report_failure(*source);
  return code == kExitOk && interrupted() ? kExitInterrupted : code;
}

}  // namespace

void add_render_command(Arguments app, int& exit_code) {
  auto o = std::make_shared<RenderOptions>();
  Arguments c = app.add_subcommand("render", "pictures or a film of a scene or a recording");
  c.add_option("source", o->source, "recording, scene file, gallery name, or - for standard input")
      .required();
  c.add_option("-o,--output", o->output,
               "x.png (x.000000.png, x.000001.png ...), or x.mp4 or x.gif where ffmpeg is installed")
      .required();
  add_picture_options(c, o->picture);
  c.add_option("--fps", o->per_second, "pictures a second").in_range(0.001, 1000.0).shows_default();
  c.add_option("--speed", o->speed, "simulated seconds in a second of the film")
      .in_range(1e-9, 1e12)
      .shows_default();
  const Argument from =
      c.add_option("--from", o->from, "simulated time of the first picture, s").in_range(0.0, 1e12).of_time();
  const Argument to = c.add_option("--to", o->to, "simulated time of the last picture, s (default: the end)")
                          .in_range(0.0, 1e12)
                          .of_time();
  c.add_option("--at", o->at, "one picture, of this simulated time, s")
      .in_range(0.0, 1e12)
      .of_time()
      .excludes(from)
      .excludes(to);
  c.add_option("--threads", o->threads, "threads of the simulation (default: all)").in_range(1, 1024);
  c.add_option("--progress", o->progress, "progress on standard error").one_of({"auto", "plain", "none"});
  c.callback([o, &exit_code] { exit_code = render(*o); });
}

}  // namespace truestep
