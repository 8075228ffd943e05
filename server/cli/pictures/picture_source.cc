#include "server/cli/pictures/picture_source.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <thread>

#include "engine/scene/admission.h"
#include "engine/session/describe.h"
#include "engine/session/session.h"
#include "engine/sinks/picture/draw/draw_world.h"
#include "engine/sinks/recording/recorded_frames.h"
#include "engine/studies/precision/accuracy.h"
#include "server/cli/input.h"

namespace truestep {

namespace {

constexpr double kAccuracySeconds = 2;  // CPU time for choosing a method

class SceneSource final : public PictureSource {
 public:
  SceneSource(const boost::json::value& document, PictureLook look, int threads)
      : arena_(std::make_shared<const ThreadArena>(threads)),
        world_(make_world(document)),
        look_(std::move(look)),
        request_(picture_request(*world_, look_)),
        session_(world_, arena_, {.history_bytes = 0}) {}

  double begin() const override { return 0; }
  double end() const override { return world_->scene().header.time.duration; }
  DrawList at(double t) override {
    const auto step = static_cast<uint64_t>(std::llround(t / world_->dt()));
    if (step < session_.step_index()) session_.reset();
    while (session_.step_index() < step && session_.step(1) > 0) {
    }
    return draw_list_of(*world_, *session_.frame(request_), look_);
  }
  std::optional<End> failure() const override {
    if (!session_.failure()) return std::nullopt;
    return End{session_.failure()->detail, session_.time()};
  }

 private:
  std::shared_ptr<const World> make_world(const boost::json::value& document) const {
    require_admission(estimate(require_scene(examine_scene(document, kOwnMachine))), kOwnMachine);
    return std::make_shared<const World>(settle_accuracy(document, kAccuracySeconds, *arena_).scene);
  }

  std::shared_ptr<const ThreadArena> arena_;
  std::shared_ptr<const World> world_;
  PictureLook look_;
  FrameRequest request_;
  Session session_;
};

class RecordingSource final : public PictureSource {
 public:
  RecordingSource(const std::string& path, PictureLook look)
      : reader_(std::make_shared<RecordingThread>(), path), frames_(reader_), look_(std::move(look)) {}

  double begin() const override { return frames_.time(0); }
  double end() const override { return frames_.time(frames_.count() - 1); }
  DrawList at(double t) override {
    // Half a step of tolerance, since times are sums of decimal fractions.
    const double late = t + frames_.world().dt() / 2;
    uint64_t low = 0, high = frames_.count();
    while (high - low > 1) {
      const uint64_t middle = (low + high) / 2;
      if (frames_.time(middle) <= late) {
        low = middle;
      } else {
        high = middle;
      }
    }
    return draw_list_of(frames_.world(), *frames_.frame(low), look_);
  }

 private:
  RecordingReader reader_;
  RecordedFrames frames_;
  PictureLook look_;
};

// HDF5 files start like this, whatever their extension.
bool is_recording(const std::string& path) {
  constexpr std::array<char, 8> kSignature{'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
  std::array<char, 8> head{};
  std::ifstream(path, std::ios::binary).read(head.data(), head.size());
  return head == kSignature;
}

}  // namespace

std::unique_ptr<PictureSource> open_source(const std::string& source, const PictureLook& look, int threads) {
  if (source != "-" && is_recording(source)) {
    if (look.marks != Wish::none)
      throw Error("bad_request",
                  "--show: a recording holds no contacts and joints; render the scene instead");
    return std::make_unique<RecordingSource>(source, look);
  }
  const int count = threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency());
  return std::make_unique<SceneSource>(load_scene_document(source), look, count);
}

}  // namespace truestep
