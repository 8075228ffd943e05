#include "engine/session/world/part_table.h"

#include <algorithm>

namespace truestep {

PartTable::PartTable(const Scene& scene, std::span<const std::unique_ptr<const System>> systems) {
  for (size_t i = 0; i < systems.size(); ++i) {
    if (!systems[i]) continue;
    const auto& parts = systems[i]->parts();
    for (size_t k = 0; k < parts.size(); ++k) {
      const std::string& id = scene.systems[i].id;
      entries_.push_back({parts[k].name.empty() ? id : id + "." + parts[k].name, i, k, systems[i].get()});
    }
  }
}

bool PartTable::named(size_t part, std::string_view name) const {
  const std::string& id = entries_[part].id;
  if (id == name) return true;
  return id.size() > name.size() && id.starts_with(name) && id[name.size()] == '.';
}

std::optional<FieldPlace> PartTable::find(std::string_view name, std::string_view field) const {
  for (size_t i = 0; i < entries_.size(); ++i) {
    if (!named(i, name)) continue;
    if (const auto f = entries_[i].info().find(field)) return FieldPlace{i, *f};
  }
  return std::nullopt;
}

std::vector<std::string> PartTable::field_names(std::string_view name) const {
  std::vector<std::string> out;
  for (size_t i = 0; i < entries_.size(); ++i) {
    if (!name.empty() && !named(i, name)) continue;
    for (const FieldInfo& f : entries_[i].info().fields) {
      if (std::find(out.begin(), out.end(), f.name) == out.end()) out.push_back(f.name);
    }
  }
  return out;
}

std::vector<std::string> PartTable::color_names() const {
  std::vector<std::string> out;
  const auto add = [&](const std::string& name) {
    if (std::find(out.begin(), out.end(), name) == out.end()) out.push_back(name);
  };
  bool moves = false;
  for (const Entry& e : entries_) {
    if (!e.info().colorable()) continue;
    for (const FieldInfo& f : e.info().fields) add(f.name);
    moves = moves || e.info().find(Meaning::velocity);
  }
  if (moves) add("speed");
  return out;
}

std::vector<std::string> PartTable::ids() const {
  std::vector<std::string> out;
  for (const Entry& e : entries_) out.push_back(e.id);
  return out;
}

double element(const FieldView& view, size_t k) {
  switch (view.type) {
    case Scalar::f64:
      return static_cast<const double*>(view.data)[k];
    case Scalar::f32:
      return static_cast<const float*>(view.data)[k];
    case Scalar::i32:
      return static_cast<const int32_t*>(view.data)[k];
    case Scalar::u32:
      return static_cast<const uint32_t*>(view.data)[k];
    case Scalar::u64:
      return static_cast<double>(static_cast<const uint64_t*>(view.data)[k]);
  }
  return 0;
}

std::vector<std::string> component_names(const std::string& stem, uint32_t width) {
  constexpr std::string_view kAxes[] = {".x", ".y", ".z"};
  std::vector<std::string> out;
  for (uint32_t c = 0; c < width; ++c) {
    out.push_back(width == 3   ? stem + std::string(kAxes[c])
                  : width == 1 ? stem
                               : stem + "." + std::to_string(c));
  }
  return out;
}

}  // namespace truestep
