// Reading the table of outputs: parts and fields of a built system, observables, descriptions.
#include "engine/core/outputs/output_table.h"

#include <algorithm>

namespace truestep {

std::string member_name(std::string_view pattern, std::string_view member) {
  const size_t open = pattern.find('<'), close = pattern.rfind('>');
  if (open == pattern.npos) return std::string(pattern);
  std::string out(pattern.substr(0, open));
  out += member;
  return out += pattern.substr(close + 1);
}

void OutputTable::observe(const System& system, const State& state, double t, Observables& out) const {
  const auto wanted = [&](const Pass& p, std::string_view member) {
    return p.runs == Pass::Runs::always ||
           std::any_of(p.rows.begin(), p.rows.end(), [&](const Observable& row) {
             return out.wants(p.family ? member_name(row.name, member) : row.name);
           });
  };
  for (const Pass& p : passes) {
    if (p.when && !p.when(system)) continue;
    if (!p.family) {
      if (wanted(p, "")) p.run(system, state, t, 0, out);
      continue;
    }
    const std::vector<std::string> members = p.family(system);
    for (size_t k = 0; k < members.size(); ++k) {
      if (!wanted(p, members[k])) continue;
      Observables of_member;
      p.run(system, state, t, k, of_member);
      for (const Observation& o : of_member.rows()) out.add(member_name(o.name, members[k]), o.value, o.unit);
    }
  }
}

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
  const auto& [row, member] = shown.fields[field];
  const OutputTable::Field& f = *row;
  const ShownRows rows = shown.part->rows ? shown.part->rows(system, state, shown.member)
                                          : ShownRows{0, system.parts()[part].max_rows};
  return {f.get(system, state, {f.info, rows, scratch, shown.member, member}), f.info.type, rows.count,
          f.info.width};
}

}  // namespace truestep
