#include "engine/sinks/recording/recording_writer.h"

#include <atomic>
#include <cstring>
#include <mutex>
#include <optional>

#include "engine/base/errors.h"
#include "engine/sinks/recording/file/recording_file.h"
#include "engine/sinks/recording/log/chunk_plan.h"

namespace truestep {
namespace {

// Under load a flush waits for this many bytes: its cost is per call, not per byte.
constexpr size_t kFlushBytes = size_t{1} << 20;

}  // namespace

// Shared by the writer and the batches in flight.
struct RecordingWriter::Core {
  Core(std::shared_ptr<RecordingThread> t, RecordingLayout l)
      : thread(std::move(t)), layout(std::move(l)), plan(plan_chunks(layout)) {}

  const std::shared_ptr<RecordingThread> thread;
  const RecordingLayout layout;
  const ChunkPlan plan;

  // Only on the recording thread.
  std::optional<RecordingFile> file;
  size_t unflushed = 0;

  std::atomic<size_t> queued{0};
  std::atomic<uint64_t> appended{0}, durable{0};
  std::atomic<RecordingState> state{RecordingState::kRecording};
  mutable std::mutex mutex;
  std::string code, message;
  std::vector<std::unique_ptr<Batch>> free;

  void fail(const std::string& why, const std::string& text) {
    {
      std::lock_guard lock(mutex);
      code = why;
      message = text;
    }
    state = RecordingState::kFailed;
    file.reset();
  }
  void flush() {
    file->flush();
    unflushed = 0;
    durable = file->durable_frames();
  }
  // Runs `work` so that errors affect only this recording.
  template <typename Work>
  void guarded(const Work& work) noexcept {
    try {
      work();
    } catch (const Error& e) {
      fail(e.code(), e.what());
    } catch (const std::exception& e) {
      fail("internal", e.what());
    }
  }
};

// The image of up to plan.frames frames, on its way to the thread and back.
struct RecordingWriter::Batch final : RecordingTask {
  explicit Batch(std::shared_ptr<Core> c) : core(std::move(c)), size(core->plan.bytes) {
    image.reset(static_cast<std::byte*>(::operator new (size, std::align_val_t{64})));
    // A single frame fills every byte that is written.
    if (core->plan.frames > 1) std::memset(image.get(), 0, size);
  }
  struct Free {
    void operator()(std::byte* p) const { ::operator delete (p, std::align_val_t{64}); }
  };

  std::shared_ptr<Core> core;
  const size_t size;
  std::unique_ptr<std::byte, Free> image;
  size_t frames = 0;

  size_t bytes() const override { return size; }

  void run(std::unique_ptr<RecordingTask> self) noexcept override {
    const std::shared_ptr<Core> c = std::move(core);
    const size_t left = c->queued.fetch_sub(1) - 1;
    if (c->state == RecordingState::kRecording) {
      c->guarded([&] {
        if (!c->file) c->file.emplace(c->layout, c->plan);
        c->file->write(image.get(), frames);
        c->unflushed += size;
        if (left == 0 || c->unflushed >= kFlushBytes) c->flush();
      });
    }
    frames = 0;
    std::lock_guard lock(c->mutex);
    c->free.emplace_back(static_cast<Batch*>(self.release()));
  }
};

RecordingWriter::RecordingWriter(std::shared_ptr<RecordingThread> thread, RecordingLayout layout, File file) {
  validate_layout(layout);
  core_ = std::make_shared<Core>(std::move(thread), std::move(layout));
  if (file == File::at_once) core_->thread->run([&] { core_->file.emplace(core_->layout, core_->plan); });
}

RecordingWriter::~RecordingWriter() {
  finalize("");
}

void RecordingWriter::append(int64_t step, double time, std::span<const PartRows> systems,
                             std::span<const double> observables) {
  if (core_->state != RecordingState::kRecording) return;
  if (!batch_) {
    std::lock_guard lock(core_->mutex);
    if (!core_->free.empty()) {
      batch_ = std::move(core_->free.back());
      core_->free.pop_back();
    }
  }
  if (!batch_) batch_ = std::make_unique<Batch>(core_);
  fill_frame(core_->layout, core_->plan, batch_->image.get(), batch_->frames, step, time, systems,
             observables);
  ++core_->appended;
  if (++batch_->frames == core_->plan.frames) submit();
}

void RecordingWriter::submit() {
  seal_batch(core_->layout, core_->plan, batch_->image.get());
  batch_->core = core_;
  ++core_->queued;
  core_->thread->post(std::move(batch_));
}

RecordingStatus RecordingWriter::finalize(const std::string& journal, const RecordedDrawing* drawing) {
  if (batch_ && batch_->frames > 0) submit();
  core_->thread->run([&] {
    if (core_->state != RecordingState::kRecording) return;
    core_->guarded([&] {
      if (core_->file) {
        core_->flush();
        core_->file->finalize(journal, drawing);
        core_->file.reset();
      }
      core_->state = RecordingState::kFinalized;
    });
  });
  // Batches hold the core while queued or being filled, but never while idle.
  std::lock_guard lock(core_->mutex);
  core_->free.clear();
  batch_.reset();
  return {core_->state, core_->appended, core_->durable, core_->code, core_->message};
}

RecordingStatus RecordingWriter::status() const {
  std::lock_guard lock(core_->mutex);
  return {core_->state, core_->appended, core_->durable, core_->code, core_->message};
}

bool RecordingWriter::failed() const {
  return core_->state == RecordingState::kFailed;
}

uint64_t RecordingWriter::durable_frames() const {
  return core_->durable;
}
size_t RecordingWriter::frames_per_chunk() const {
  return core_->plan.frames;
}
const RecordingLayout& RecordingWriter::layout() const {
  return core_->layout;
}

}  // namespace truestep
