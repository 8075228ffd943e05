#include "server/cli/run/series_csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>

#include "engine/base/errors.h"
#include "engine/session/snapshot/references.h"

namespace truestep {

namespace {

std::string number(double v) {
  if (std::isnan(v)) return "";
  char text[40];
  return {text, std::to_chars(text, text + sizeof text, v).ptr};
}

}  // namespace

bool SeriesCsv::Choice::has(std::string_view name) const {
  return std::any_of(columns.begin(), columns.end(), [&](const Observation& c) { return c.name == name; });
}

Observables SeriesCsv::Choice::of(const Observables& all) const {
  Observables out;
  for (const Observation& o : all.rows()) {
    if (has(o.name)) out.add(o.name, o.value, o.unit);
  }
  return out;
}

SeriesCsv::SeriesCsv(const std::string& path, const Choice& choice)
    : path_(path), columns_(choice.columns), out_(path == "-" ? std::cout : file_) {
  if (path != "-") file_.open(path, std::ios::binary);
  out_ << "step,time [s]";
  for (const Observation& c : columns_) out_ << ',' << c.name << " [" << c.unit << ']';
  out_ << '\n';
  if (!out_) throw Error("write_failed", "cannot write " + path);
}

void SeriesCsv::add(uint64_t step, double time, const Observables& values) {
  out_ << step << ',' << number(time);
  // Both are in the same order, so the next column is nearly always the next value.
  const auto& rows = values.rows();
  size_t k = 0;
  for (const Observation& c : columns_) {
    for (size_t tried = 0; tried < rows.size() && rows[k % rows.size()].name != c.name; ++tried) ++k;
    out_ << ',';
    if (!rows.empty() && rows[k % rows.size()].name == c.name) out_ << number(rows[k++ % rows.size()].value);
  }
  out_ << '\n';
}

void SeriesCsv::finish() {
  if (!out_.flush()) throw Error("write_failed", "cannot write " + path_);
}

SeriesCsv::Choice choose_observables(const World& world, const std::vector<std::string>& entries) {
  const auto known = world.known_observables();
  std::vector<Issue> issues;
  for (const std::string& e : entries) {
    if (auto fault = unknown_observable(e, "--observe", known)) issues.push_back(std::move(*fault));
  }
  if (!issues.empty()) throw Error("bad_request", "no observable has this name", std::move(issues));
  const auto& wanted = entries.empty() ? world.scene().header.observables : entries;
  SeriesCsv::Choice out;
  for (const Observation& o : known) {
    const auto means = [&](const std::string& w) { return selects(w, o.name); };
    if (wanted.empty() || std::any_of(wanted.begin(), wanted.end(), means)) out.columns.push_back(o);
  }
  return out;
}

}  // namespace truestep
