// Reading the table of outputs: parts and fields of a built system, observables, descriptions.
#include "engine/core/outputs/output_table.h"

#include <algorithm>

namespace truestep {

Outputs OutputTable::described() const {
  Outputs out{.rows = rows, .fields = {}, .observables = {}};
  for (const Part& p : parts) {
    for (const Field& f : p.fields) {
      if (f.listed.empty()) continue;
      out.fields.push_back(
          {.name = f.listed, .unit = f.info.unit, .width = f.info.width, .sentence = f.sentence});
    }
  }
  for (const Pass& p : passes) {
    for (const Observable& o : p.rows)
      out.observables.push_back({.name = o.name, .unit = o.unit, .sentence = o.sentence});
  }
  return out;
}

Outputs OutputTable::described_with(const OutputTable& other) const {
  Outputs out = described();
  const auto add = [](auto& to, const auto& from) {
    for (const auto& row : from) {
      if (std::ranges::find(to, row.name, [](const auto& r) { return r.name; }) == to.end())
        to.push_back(row);
    }
  };
  const Outputs theirs = other.described();
  add(out.fields, theirs.fields), add(out.observables, theirs.observables);
  return out;
}

PartInfo points_part(size_t max_rows) {
  PartInfo part;
  part.max_rows = max_rows;
  return part;
}

PartInfo values_part(size_t max_rows, PartInfo::Elements elements) {
  PartInfo part;
  part.kind = PartInfo::Kind::values, part.max_rows = max_rows, part.elements = elements;
  return part;
}

namespace {

/// "door.<id>.flow" of the member "exit": "door.exit.flow"; "joint.<id>.<axis>" of "hip.x": "joint.hip.x".
std::string member_name(std::string_view pattern, std::string_view member) {
  const size_t open = pattern.find('<'), close = pattern.rfind('>');
  if (open == pattern.npos) return std::string(pattern);
  std::string out(pattern.substr(0, open));
  out += member;
  return out += pattern.substr(close + 1);
}

}  // namespace

std::vector<PartInfo> ShownFields::choose(const OutputTable& table, const System& system) {
  std::vector<PartInfo> out;
  shown_.clear();
  for (const OutputTable::Part& row : table.parts) {
    size_t member = 0;
    for (PartInfo& part : row.present(system)) {
      if (part.name.empty()) part.name = row.name;
      Shown& shown = shown_.emplace_back(Shown{&row, member++, {}});
      for (const OutputTable::Field& f : row.fields) {
        if (f.when && !f.when(system)) continue;
        const auto names = f.family ? f.family(system, shown.member) : std::vector<std::string>(1);
        for (size_t k = 0; k < names.size(); ++k) {
          shown.fields.push_back({&f, k});
          part.fields.push_back(f.info);
          if (f.type) part.fields.back().type = f.type(system);
          if (f.family) part.fields.back().name = member_name(f.info.name, names[k]);
        }
      }
      out.push_back(std::move(part));
    }
  }
  return out;
}

FieldView ShownFields::field(const System& system, const State& state, size_t part, size_t field,
                             std::vector<double>& scratch) const {
  const Shown& shown = shown_[part];
  const FieldInfo& info = system.parts()[part].fields[field];
  const ShownRows rows = shown.part->rows ? shown.part->rows(system, state, shown.member)
                                          : ShownRows{0, system.parts()[part].max_rows};
  const auto& [row, member] = shown.fields[field];
  return {row->get(system, state, {info, rows, scratch, shown.member, member}), info.type, rows.count,
          info.width};
}

void ShownObservables::choose(const OutputTable& table, const System& system) const {
  for (const OutputTable::Pass& p : table.passes) {
    if (p.when && !p.when(system)) continue;
    Shown shown{&p, {}, {}};
    for (const std::string& member : p.family ? p.family(system) : std::vector<std::string>(1)) {
      shown.members.push_back(shown.members.size());
      for (const OutputTable::Observable& row : p.rows)
        shown.names.push_back(p.family ? member_name(row.name, member) : row.name);
    }
    if (!shown.members.empty()) shown_.push_back(std::move(shown));
  }
}

void ShownObservables::observe(const OutputTable& table, const System& system, const State& state, double t,
                               Observables& out) const {
  std::call_once(chosen_, [&] { choose(table, system); });
  for (const Shown& p : shown_) {
    const size_t rows = p.pass->rows.size();
    const auto wanted = [&](size_t member) {
      const auto first = p.names.begin() + static_cast<ptrdiff_t>(member * rows);
      return std::any_of(first, first + static_cast<ptrdiff_t>(rows),
                         [&](const std::string& name) { return out.wants(name); });
    };
    const auto run = [&](std::span<const size_t> members) {
      p.pass->run(system, state, t, members, [&p, &out](size_t member, size_t row, double value) {
        out.add(p.names[member * p.pass->rows.size() + row], value, p.pass->rows[row].unit);
      });
    };
    if (p.pass->runs == OutputTable::Pass::Runs::always) {
      run(p.members);
      continue;
    }
    std::vector<size_t> members;
    std::ranges::copy_if(p.members, std::back_inserter(members), wanted);
    if (!members.empty()) run(members);
  }
}

}  // namespace truestep
