// Whether a picture shows what a scene is about, judged by numbers alone: what moves is inside the frame, and
// no text lies on other text.
#pragma once
#include "engine/session/session.h"

namespace truestep::gallery_pass {

/// How the picture is spoilt, for a control.
enum class Spoil : uint8_t { nothing, camera };

/// False after a sentence about what is wrong with the picture of the present state.
bool is_pictured(const Session& session, Spoil spoil);

}  // namespace truestep::gallery_pass
