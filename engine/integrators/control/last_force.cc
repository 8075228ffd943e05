#include "engine/integrators/control/last_force.h"

#include <cstring>

namespace truestep {

namespace {
template <class Visit>
void each_column(const State& s, Visit visit) {
  for (State::Column c = 0; c < s.columns(); ++c) {
    if (s.info(c).role != Role::velocity) visit(s.bytes(c));
  }
}
}  // namespace

bool LastForce::holds(const Motion& m, double t) const {
  if (field_ != &m.field || t_ != t) return false;
  size_t at = 0;
  bool same = true;
  each_column(m.state, [&](std::span<const std::byte> bytes) {
    same = same && at + bytes.size() <= image_.size() &&
           (bytes.empty() || std::memcmp(image_.data() + at, bytes.data(), bytes.size()) == 0);
    at += bytes.size();
  });
  return same && at == image_.size();
}

void LastForce::keep(const Motion& m, double t) {
  field_ = nullptr;
  if (m.field.dependence() != Dependence::position) return;
  field_ = &m.field, t_ = t;
  size_t size = 0;
  each_column(m.state, [&](std::span<const std::byte> bytes) { size += bytes.size(); });
  image_.resize(size);
  std::byte* to = image_.data();
  each_column(m.state, [&](std::span<const std::byte> bytes) {
    if (!bytes.empty()) std::memcpy(to, bytes.data(), bytes.size());
    to += bytes.size();
  });
}

}  // namespace truestep
