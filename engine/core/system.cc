#include "engine/core/system.h"

template class std::vector<truestep::PlanRow>;
template class std::vector<truestep::Stage>;

namespace truestep {

System::System() = default;
System::~System() = default;

void System::set_parts(std::vector<PartInfo> parts) {
  parts_ = std::move(parts);
}

void System::set_remedies(std::vector<std::string> remedies) {
  remedies_ = std::move(remedies);
}

StagedSystem::StagedSystem() = default;
StagedSystem::~StagedSystem() = default;

std::optional<FieldPlace> System::find_field(std::string_view name) const {
  for (size_t p = 0; p < parts_.size(); ++p) {
    if (const auto f = parts_[p].find(name)) return FieldPlace{p, *f};
  }
  return std::nullopt;
}

void StagedSystem::step(State& state, const StepInput& input) const {
  for (const Stage& stage : stages_) {
    ProfileScope scope(input.profile, stage.name);
    stage.run(state, input);
  }
}

std::vector<PlanRow> StagedSystem::plan() const {
  std::vector<PlanRow> rows;
  for (const Stage& s : stages_) rows.push_back({PlanRow::Status::runs, s.name, s.reason});
  rows.insert(rows.end(), skipped_.begin(), skipped_.end());
  return rows;
}

void StagedSystem::add_stage(std::string name, std::string reason,
                             std::function<void(State&, const StepInput&)> run) {
  stages_.push_back({std::move(name), std::move(reason), std::move(run)});
}

void StagedSystem::skip_stage(std::string name, std::string reason) {
  skipped_.push_back({PlanRow::Status::skipped, std::move(name), std::move(reason)});
}

}  // namespace truestep
