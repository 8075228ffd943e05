// Files that `truestep run` writes beside its report: a recording while it runs, a picture at the end.
#pragma once
#include <memory>
#include <string>

#include "engine/session/session.h"

namespace truestep {

class RecordingSink;

class RunOutputs {
 public:
  /// Attaches a recording to the session when `recording_path` is not empty.
  RunOutputs(Session& session, const std::string& recording_path, std::string picture_path);
  /// Completes the recording and draws the picture; throws Error when a file cannot be written.
  void finish();

 private:
  Session& session_;
  std::string picture_path_;
  std::shared_ptr<RecordingSink> recording_;
};

}  // namespace truestep
