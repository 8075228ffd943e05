#include "server/cli/run_outputs.h"

#include <fstream>

#include "engine/sinks/picture/draw_world.h"
#include "engine/sinks/picture/picture.h"
#include "engine/sinks/recording/recording_sink.h"

namespace truestep {

RunOutputs::RunOutputs(Session& session, const std::string& recording_path, PictureWish picture)
    : session_(session), picture_(std::move(picture)) {
  if (recording_path.empty()) return;
  recording_ = std::make_shared<RecordingSink>(std::make_shared<RecordingThread>(), session, recording_path);
  session.add_sink(recording_);
}

void RunOutputs::finish() {
  if (recording_) {
    const RecordingStatus status = recording_->finish();
    if (status.state == RecordingState::kFailed) throw Error(status.code, status.message);
  }
  if (picture_.path.empty()) return;
  constexpr int kWidth = 1280, kHeight = 720;
  PictureRenderer renderer(kWidth, kHeight);
  const auto shown = [&](const char* name, Wish wish) {
    return picture_.show.find(name) != std::string::npos ? wish : Wish::none;
  };
  const World& world = session_.world();
  const Wish marks = shown("contacts", Wish::contacts) | shown("joints", Wish::joints);
  const auto list = draw_list_of(world, *session_.frame(picture_request(world, {.marks = marks})));
  const auto png = encode_png(renderer.render_rgba(list), kWidth, kHeight);
  std::ofstream file(picture_.path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  if (!file.flush()) throw Error("write_failed", "cannot write " + picture_.path);
}

}  // namespace truestep
