#include "engine/sinks/recording/file/layout.h"

#include <set>

#include "engine/base/errors.h"

namespace truestep {
namespace {

// A name becomes an HDF5 link: it must not be empty, a path or a relative directory.
bool is_link_name(const std::string& s) {
  return !s.empty() && s != "." && s != ".." && s.find('/') == std::string::npos &&
         s.find('\0') == std::string::npos;
}

struct Check {
  std::vector<Issue> issues;
  void add(const std::string& pointer, const std::string& message, const std::string& value) {
    issues.push_back({pointer, "recording_invalid", message, value, "", "", ""});
  }
  void name(const std::string& pointer, const std::string& s, std::set<std::string>& seen) {
    if (!is_link_name(s)) add(pointer, "the name is empty or contains '/'", s);
    if (!seen.insert(s).second) add(pointer, "the name is used twice", s);
  }
  void indices(const std::string& pointer, const std::vector<uint32_t>& v, size_t arity, uint32_t rows) {
    if (v.size() % arity != 0)
      add(pointer, "the number of indices must be a multiple of the cell's corners", "");
    for (uint32_t i : v) {
      if (i >= rows) return add(pointer, "an index is not below max_rows", std::to_string(i));
    }
  }
};

}  // namespace

void validate_layout(const RecordingLayout& layout) {
  Check check;
  std::set<std::string> ids, observables;
  for (size_t s = 0; s < layout.parts.size(); ++s) {
    const RecordedPart& system = layout.parts[s];
    const std::string at = "/systems/" + std::to_string(s);
    check.name(at + "/id", system.id, ids);
    if (system.max_rows == 0) check.add(at + "/max_rows", "a system must have at least one row", "0");
    if (system.kind == PartInfo::Kind::grid &&
        (system.rows != RowPolicy::kFixed || system.lattice.rows() != system.max_rows)) {
      check.add(at + "/lattice", "a grid must have the rows of its lattice", std::to_string(system.max_rows));
    }
    if (system.fields.empty()) check.add(at + "/fields", "a system must have at least one field", "");
    std::set<std::string> fields{"box", "rows"};  // both are links of the system's own group
    for (const RecordedField& field : system.fields) {
      check.name(at + "/fields/" + field.name, field.name, fields);
      if (field.width == 0) check.add(at + "/fields/" + field.name, "the width must be at least 1", "0");
    }
    check.indices(at + "/lines", system.lines, 2, system.max_rows);
    check.indices(at + "/triangles", system.triangles, 3, system.max_rows);
    if (system.rows == RowPolicy::kVariable && !(system.lines.empty() && system.triangles.empty())) {
      check.add(at + "/rows", "static topology needs a fixed number of rows", "");
    }
  }
  for (const RecordedObservable& o : layout.observables) {
    check.name("/observables/" + o.name, o.name, observables);
  }
  if (!check.issues.empty()) {
    const std::string first = check.issues.front().pointer + ": " + check.issues.front().message;
    throw Error("recording_invalid", "this cannot be recorded: " + first, std::move(check.issues));
  }
}

}  // namespace truestep
