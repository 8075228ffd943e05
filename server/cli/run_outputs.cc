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
  const Overlay contacts =
      picture_.show.find("contacts") != std::string::npos ? Overlay::contacts : Overlay::none;
  const Overlay joints = picture_.show.find("joints") != std::string::npos ? Overlay::joints : Overlay::none;
  const auto list = draw_list_of(session_.world(), session_.state(), contacts | joints);
  const auto png = encode_png(renderer.render_rgba(list), kWidth, kHeight);
  std::ofstream file(picture_.path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  if (!file.flush()) throw Error("write_failed", "cannot write " + picture_.path);
}

}  // namespace truestep
