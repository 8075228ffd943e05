#include "engine/sinks/recording/diff.h"

#include <algorithm>
#include <cmath>

namespace truestep {
namespace {

using Kind = RecordingDifference::Kind;

bool differ(double a, double b, double tolerance) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) != std::isnan(b);
  return a != b && !(std::abs(a - b) <= tolerance);
}

std::optional<RecordingDifference> structure(const RecordingLayout& a, const RecordingLayout& b) {
  const auto part = [](const std::string& what) {
    RecordingDifference d;
    d.message = "the recordings have different contents: " + what;
    return d;
  };
  if (a.parts.size() != b.parts.size()) return part("the number of systems");
  for (size_t s = 0; s < a.parts.size(); ++s) {
    const RecordedPart &x = a.parts[s], &y = b.parts[s];
    if (x.id != y.id) return part("system '" + x.id + "' and '" + y.id + "'");
    const bool same =
        std::equal(x.fields.begin(), x.fields.end(), y.fields.begin(), y.fields.end(),
                   [](const auto& f, const auto& g) { return f.name == g.name && f.width == g.width; });
    if (!same) return part("the fields of '" + x.id + "'");
    if (x.lines != y.lines || x.triangles != y.triangles) return part("the topology of '" + x.id + "'");
  }
  const bool same =
      std::equal(a.observables.begin(), a.observables.end(), b.observables.begin(), b.observables.end(),
                 [](const auto& f, const auto& g) { return f.name == g.name; });
  if (!same) return part("the observables");
  return std::nullopt;
}

// The first element that differs, with the largest difference beside it.
bool differ(const std::vector<double>& a, const std::vector<double>& b, size_t width, double tolerance,
            RecordingDifference& d) {
  bool found = false;
  for (size_t i = 0; i < a.size(); ++i) {
    if (!differ(a[i], b[i], tolerance)) continue;
    if (!found) {
      d.row = i / width;
      d.component = i % width;
      d.first = a[i];
      d.second = b[i];
    }
    found = true;
    d.largest = std::fmax(d.largest, std::abs(a[i] - b[i]));
  }
  return found;
}

bool differ(const RecordedPart& system, const RecordedRows& a, const RecordedRows& b, double tolerance,
            RecordingDifference& d) {
  d.system = system.id;
  if (a.rows != b.rows) {
    d.kind = Kind::kRows;
    d.first = static_cast<double>(a.rows);
    d.second = static_cast<double>(b.rows);
    d.largest = std::abs(d.first - d.second);
    return true;
  }
  d.kind = Kind::kField;
  for (size_t f = 0; f < system.fields.size(); ++f) {
    d.field = system.fields[f].name;
    if (differ(a.fields[f], b.fields[f], system.fields[f].width, tolerance, d)) return true;
  }
  d.system.clear();
  d.field.clear();
  return false;
}

bool differ(const RecordingLayout& layout, const RecordedFrame& a, const RecordedFrame& b, double tolerance,
            RecordingDifference& d) {
  d.step = a.step;
  if (a.step != b.step || a.time != b.time) {
    d.kind = Kind::kClock;
    d.first = static_cast<double>(a.step);
    d.second = static_cast<double>(b.step);
    return true;
  }
  for (size_t s = 0; s < a.systems.size(); ++s) {
    if (differ(layout.parts[s], a.systems[s], b.systems[s], tolerance, d)) return true;
  }
  d.kind = Kind::kObservable;
  for (size_t o = 0; o < a.observables.size(); ++o) {
    if (!differ(a.observables[o], b.observables[o], tolerance)) continue;
    d.field = layout.observables[o].name;
    d.first = a.observables[o];
    d.second = b.observables[o];
    d.largest = std::abs(d.first - d.second);
    return true;
  }
  return false;
}

std::string sentence(const RecordingDifference& d) {
  const std::string at = "at step " + std::to_string(d.step) + " (frame " + std::to_string(d.frame) + ") ";
  const std::string by = " differs by up to " + std::to_string(d.largest);
  switch (d.kind) {
    case Kind::kClock:
      return at + "the clocks differ";
    case Kind::kRows:
      return at + "the number of rows of " + d.system + by;
    case Kind::kField:
      return at + d.system + "." + d.field + by + ", first in row " + std::to_string(d.row);
    case Kind::kObservable:
      return at + d.field + by;
    case Kind::kStructure:
    case Kind::kLength:
      break;
  }
  return d.message;
}

}  // namespace

std::optional<RecordingDifference> first_difference(RecordingReader& a, RecordingReader& b,
                                                    double tolerance) {
  const RecordingLayout& layout = a.info().layout;
  if (auto d = structure(layout, b.info().layout)) return d;
  RecordedFrame x, y;
  const uint64_t frames = std::min(a.info().frames, b.info().frames);
  for (uint64_t i = 0; i < frames; ++i) {
    a.read(i, x);
    b.read(i, y);
    RecordingDifference d;
    d.frame = i;
    if (differ(layout, x, y, tolerance, d)) {
      d.message = sentence(d);
      return d;
    }
  }
  if (a.info().frames == b.info().frames) return std::nullopt;
  RecordingDifference d;
  d.kind = Kind::kLength;
  d.frame = frames;
  d.first = static_cast<double>(a.info().frames);
  d.second = static_cast<double>(b.info().frames);
  d.message = "all " + std::to_string(frames) + " common frames agree, but one recording is longer";
  return d;
}

}  // namespace truestep
