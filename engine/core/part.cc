// Looking up fields of a part.
#include "engine/core/part.h"

#include <algorithm>

template class std::vector<truestep::FieldInfo>;
template class std::vector<truestep::PartInfo>;

namespace truestep {

namespace {

template <class Is>
std::optional<size_t> first(const std::vector<FieldInfo>& fields, const Is& is) {
  const auto at = std::find_if(fields.begin(), fields.end(), is);
  return at == fields.end() ? std::nullopt : std::optional(static_cast<size_t>(at - fields.begin()));
}

}  // namespace

std::optional<size_t> PartInfo::find(std::string_view field) const {
  return first(fields, [&](const FieldInfo& f) { return f.name == field; });
}

std::optional<size_t> PartInfo::find(Meaning meaning) const {
  return first(fields, [&](const FieldInfo& f) { return f.meaning == meaning; });
}

}  // namespace truestep
