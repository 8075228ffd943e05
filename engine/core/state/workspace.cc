#include "engine/core/state/workspace.h"

namespace truestep {

Workspace::Workspace() = default;
Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;

void* Workspace::find(std::string_view key, const std::type_info& type) const {
  for (const Slot& s : slots_) {
    if (s.key == key && *s.type == type) return s.object.get();
  }
  return nullptr;
}

void* Workspace::add(std::string_view key, const std::type_info& type, std::shared_ptr<void> object) {
  slots_.push_back({std::string(key), &type, std::move(object)});
  return slots_.back().object.get();
}

std::span<double> Workspace::doubles(std::string_view key, size_t n) {
  auto& data = object<std::vector<double, CacheLineAllocator<double>>>(key);
  if (data.size() < n) data.resize(n);
  return {data.data(), n};
}

void Workspace::clear() {
  slots_.clear();
}

}  // namespace truestep
