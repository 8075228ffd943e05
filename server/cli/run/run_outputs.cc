#include "server/cli/run/run_outputs.h"

#include <filesystem>

#include "engine/sinks/picture/draw/draw_world.h"
#include "engine/sinks/picture/picture.h"
#include "engine/sinks/recording/recording_sink.h"
#include "server/cli/pictures/movie.h"

namespace truestep {

RunOutputs::RunOutputs(Session& session, const std::string& recording_path, PictureWish picture)
    : session_(session), picture_(std::move(picture)) {
  if (!picture_.path.empty()) trails_ = TrailSink::of(session.world());
  if (trails_) session.add_sink(trails_);
  if (recording_path.empty()) return;
  make_folder_of(recording_path);
  // A link that the user gives leads to where the recording is to be; the sink itself follows none.
  recording_ = std::make_shared<RecordingSink>(std::make_shared<RecordingThread>(), session,
                                               std::filesystem::weakly_canonical(recording_path).string());
  session.add_sink(recording_);
}

void RunOutputs::finish() {
  if (recording_) {
    const RecordingStatus status = recording_->finish();
    if (status.state == RecordingState::kFailed) throw Error(status.code, status.message);
  }
  if (picture_.path.empty()) return;
  const PictureSize size = picture_size(picture_.look);
  PictureRenderer renderer(size.width, size.height);
  const World& world = session_.world();
  PictureLook look = picture_look(picture_.look);
  look.trails = trails_;
  auto list = draw_list_of(world, *session_.frame(picture_request(world, look)), look);
  aim(picture_.look, list);
  write_png(picture_.path, renderer.render_rgba(list), size);
}

}  // namespace truestep
