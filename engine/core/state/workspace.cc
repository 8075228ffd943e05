// Scratch memory by key; out of line, because nearly every system asks for some.
#include "engine/core/state/workspace.h"

#include <utility>

namespace truestep {

namespace {

struct Doubles {
  std::vector<double, CacheLineAllocator<double>> data;
};

}  // namespace

Workspace::Workspace() = default;
Workspace::Workspace(const Workspace&) = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(const Workspace&) = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;
Workspace::~Workspace() = default;

std::span<double> Workspace::doubles(std::string_view key, size_t n) {
  auto& data = object<Doubles>(key).data;
  if (data.size() < n) data.resize(n);
  return {data.data(), n};
}

void Workspace::clear() {
  slots_.clear();
}

void* Workspace::find(std::string_view key, const std::type_info& type) {
  for (Slot& s : slots_) {
    if (s.key == key && *s.type == type) return s.object.get();
  }
  return nullptr;
}

void* Workspace::keep(std::string_view key, const std::type_info& type, std::shared_ptr<void> object) {
  slots_.push_back({std::string(key), &type, std::move(object)});
  return slots_.back().object.get();
}

}  // namespace truestep
