// Files that `truestep run` writes besides its report: a recording during the run, a picture at the end.
#pragma once
#include <memory>
#include <string>

#include "engine/session/session.h"
#include "server/cli/pictures/picture_options.h"

namespace truestep {

class RecordingSink;
class TrailSink;

/// A picture of the last frame: its path (empty: none) and its look.
struct PictureWish {
  std::string path;
  PictureOptions look;
};

class RunOutputs {
 public:
  /// Attaches a recording to the session when `recording_path` is not empty.
  RunOutputs(Session& session, const std::string& recording_path, PictureWish picture);
  /// Completes the recording and draws the picture; throws Error when a file cannot be written.
  void finish();

 private:
  Session& session_;
  PictureWish picture_;
  std::shared_ptr<TrailSink> trails_;
  std::shared_ptr<RecordingSink> recording_;
};

}  // namespace truestep
