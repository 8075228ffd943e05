// A scene's draw list after some steps, as pictures take it from a session.
#pragma once
#include <memory>
#include <string>

#include "engine/session/session.h"
#include "engine/sinks/picture/draw/draw_world.h"

namespace truestep::test {

class PictureSession {
 public:
  PictureSession(const std::string& scene, uint64_t steps)
      : session_(std::make_shared<const World>(parse_scene(scene)), std::make_shared<const ThreadArena>(1)) {
    if (steps > 0) session_.step(steps);
  }
  DrawList list(const PictureLook& look = {}) const {
    return draw_list_of(session_.world(), *session_.frame(picture_request(session_.world(), look)), look);
  }
  Session& session() { return session_; }

 private:
  Session session_;
};

}  // namespace truestep::test
