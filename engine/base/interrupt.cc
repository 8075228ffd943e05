#include "engine/base/interrupt.h"

namespace truestep {

Interrupted::Interrupted() : Error("cancelled", "the work was interrupted") {}
Interrupted::Interrupted(const Interrupted&) = default;
Interrupted::~Interrupted() = default;

namespace interrupt_detail {

void stop() {
  throw Interrupted();
}

}  // namespace interrupt_detail

}  // namespace truestep
