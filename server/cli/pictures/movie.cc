#include "server/cli/pictures/movie.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>
#include <vector>

#include "engine/base/errors.h"
#include "engine/sinks/picture/png.h"

extern char** environ;

namespace truestep {

namespace fs = std::filesystem;

namespace {

class PngSequence final : public PictureFiles {
 public:
  PngSequence(fs::path path, PictureSize size) : stem_(path.replace_extension()), size_(size) {}

  void add(std::span<const uint8_t> rgba) override {
    char number[24];
    std::snprintf(number, sizeof number, ".%06llu.png", static_cast<unsigned long long>(count_++));
    write_png(stem_.string() + number, rgba, size_);
  }
  void finish() override {}
  std::string summary() const override {
    return stem_.string() + ".000000.png and so on: " + std::to_string(count_) + " pictures";
  }

 private:
  fs::path stem_;
  PictureSize size_;
  uint64_t count_ = 0;
};

bool on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (!folder.empty() && access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

/// A running ffmpeg that reads raw pictures from a pipe.
class Film final : public PictureFiles {
 public:
  Film(const fs::path& path, PictureSize size, double per_second) : path_(path.string()) {
    if (!on_path("ffmpeg")) {
      throw Error("not_found", "a " + path.extension().string() +
                                   " is made by ffmpeg, which is not installed: install it (Debian: apt-get "
                                   "install ffmpeg), or give a name that ends in .png");
    }
    make_folder_of(path_);
    std::ostringstream rate;
    rate << per_second;
    std::vector<std::string> words{"ffmpeg",
                                   "-hide_banner",
                                   "-loglevel",
                                   "error",
                                   "-y",
                                   "-f",
                                   "rawvideo",
                                   "-pixel_format",
                                   "rgba",
                                   "-video_size",
                                   std::to_string(size.width) + "x" + std::to_string(size.height),
                                   "-framerate",
                                   rate.str(),
                                   "-i",
                                   "-"};
    const bool gif = path.extension() == ".gif";
    // GIF: a palette of its own for each film. Video: players want even sizes and subsampled colour.
    const std::vector<std::string> form =
        gif ? std::vector<std::string>{"-filter_complex", "split[a][b];[a]palettegen[p];[b][p]paletteuse"}
            : std::vector<std::string>{"-vf",       "crop=trunc(iw/2)*2:trunc(ih/2)*2",
                                       "-pix_fmt",  "yuv420p",
                                       "-movflags", "+faststart"};
    words.insert(words.end(), form.begin(), form.end());
    words.push_back(fs::absolute(path).string());
    start(words);
  }
  ~Film() override {
    if (pipe_ >= 0) close(pipe_);
    if (child_ > 0) waitpid(child_, nullptr, 0);
  }

  void add(std::span<const uint8_t> rgba) override {
    for (size_t done = 0; done < rgba.size();) {
      const ssize_t n = write(pipe_, rgba.data() + done, rgba.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) {
        finish();  // throws with the reason why ffmpeg ended
        throw Error("write_failed", "ffmpeg accepted no pictures for " + path_);
      }
      done += static_cast<size_t>(n);
    }
    ++count_;
  }

  void finish() override {
    close(std::exchange(pipe_, -1));
    int status = 0;
    while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
    child_ = 0;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
      throw Error("write_failed", "ffmpeg could not write " + path_);
  }
  std::string summary() const override { return path_ + ": " + std::to_string(count_) + " pictures"; }

 private:
  // In a process group of its own, so that Ctrl-C stops the rendering but not ffmpeg.
  void start(const std::vector<std::string>& words) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw Error("write_failed", "no pipe for ffmpeg");
    signal(SIGPIPE, SIG_IGN);
    std::vector<char*> arguments;
    for (const std::string& w : words) arguments.push_back(const_cast<char*>(w.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes, 0);
    const int failed = posix_spawnp(&child_, "ffmpeg", &actions, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[0]);
    pipe_ = ends[1];
    if (failed) {
      child_ = 0;
      throw Error("write_failed", "ffmpeg cannot be started");
    }
  }

  std::string path_;
  pid_t child_ = 0;
  int pipe_ = -1;
  uint64_t count_ = 0;
};

}  // namespace

void make_folder_of(const std::string& file) {
  std::error_code failed;
  if (const fs::path folder = fs::path(file).parent_path(); !folder.empty())
    fs::create_directories(folder, failed);
  if (failed) throw Error("write_failed", "cannot make the folder of " + file + ": " + failed.message());
}

void write_png(const std::string& path, std::span<const uint8_t> rgba, PictureSize size) {
  make_folder_of(path);
  const auto png = encode_png(rgba, size.width, size.height);
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  if (!file.flush()) throw Error("write_failed", "cannot write " + path);
}

std::unique_ptr<PictureFiles> open_pictures(const std::string& path, PictureSize size, double per_second) {
  const fs::path p = path;
  if (p.extension() == ".png") return std::make_unique<PngSequence>(p, size);
  if (p.extension() == ".mp4" || p.extension() == ".gif") return std::make_unique<Film>(p, size, per_second);
  throw Error("bad_request", "-o " + path + ": pictures are .png files, films .mp4 or .gif");
}

}  // namespace truestep
