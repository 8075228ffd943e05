#include "engine/geometry/read/trc.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "engine/base/text/encoding.h"
#include "engine/geometry/read/text_lines.h"

namespace truestep {

namespace {

constexpr size_t kMostMarkers = 10'000, kMostFrames = 1'000'000, kMostPlaces = 20'000'000;

std::string_view trimmed(std::string_view s) {
  while (!s.empty() && (s.front() == ' ' || s.front() == '\r' || s.front() == '\t')) s.remove_prefix(1);
  while (!s.empty() && (s.back() == ' ' || s.back() == '\r' || s.back() == '\t')) s.remove_suffix(1);
  return s;
}

/// Tab-separated fields, trimmed, including empty ones.
std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> out;
  for (;;) {
    const size_t tab = line.find('\t');
    out.push_back(trimmed(line.substr(0, tab)));
    if (tab == std::string_view::npos) return out;
    line.remove_prefix(tab + 1);
  }
}

std::optional<double> number(std::string_view s) {
  if (s.empty()) return std::nullopt;
  double x = 0;
  const auto [end, fault] = std::from_chars(s.data(), s.data() + s.size(), x);
  if (fault != std::errc() || end != s.data() + s.size()) return std::nullopt;
  return x;
}

double require(std::span<const std::string_view> fields, size_t k, size_t line, const char* what,
               double least, double most) {
  const auto x = k < fields.size() ? number(fields[k]) : std::nullopt;
  if (!x) throw TrcFault(line, std::string("there is no ") + what);
  if (!(*x >= least && *x <= most)) {
    throw TrcFault(line, std::string(what) + " is " + std::string(fields[k]) + ", which is out of range");
  }
  return *x;
}

/// Not a number, as C, Python, Matlab and Visual C++ of old write it.
bool is_nan(std::string_view s) {
  if (s.starts_with('-') || s.starts_with('+')) s.remove_prefix(1);
  return same_word(s.substr(0, 3), "nan") || s.starts_with("1.#");
}

double metres(std::string_view unit, size_t line) {
  if (same_word(unit, "mm")) return 0.001;
  if (same_word(unit, "cm")) return 0.01;
  if (same_word(unit, "m")) return 1;
  throw TrcFault(line, "the unit is \"" + std::string(unit) + "\", not mm, cm or m");
}

}  // namespace

MarkerTracks read_trc(std::span<const std::string> lines) {
  MarkerTracks out;
  if (lines.empty() || !trimmed(without_byte_order_mark(lines[0])).starts_with("PathFileType")) {
    throw TrcFault(1, "a TRC file begins with PathFileType");
  }
  if (lines.size() < 5) throw TrcFault(lines.size(), "the heading must have five lines");
  const auto heading = fields_of(lines[2]);
  out.rate = require(heading, 0, 3, "rate", 1e-3, 1e6);
  const double frames = require(heading, 2, 3, "number of frames", 1, static_cast<double>(kMostFrames));
  const double markers = require(heading, 3, 3, "number of markers", 1, static_cast<double>(kMostMarkers));
  if (frames != std::floor(frames) || markers != std::floor(markers))
    throw TrcFault(3, "a count must be a whole number");
  if (frames * markers > static_cast<double>(kMostPlaces)) throw TrcFault(3, "there are too many positions");
  if (heading.size() < 5) throw TrcFault(3, "there is no unit of length");
  const double unit = metres(heading[4], 3);
  const auto count = static_cast<size_t>(markers);
  for (const std::string_view name : fields_of(lines[3])) {
    const bool column = same_word(name, "Frame#") || same_word(name, "Frame") || same_word(name, "Time");
    if (!name.empty() && !(column && out.names.empty())) out.names.emplace_back(name);
  }
  if (out.names.size() != count) {
    throw TrcFault(4, "there are " + std::to_string(out.names.size()) + " names of " + std::to_string(count) +
                          " markers");
  }
  std::optional<double> before;
  for (size_t l = 5; l < lines.size(); ++l) {
    if (trimmed(lines[l]).empty()) continue;
    const auto fields = fields_of(lines[l]);
    if (fields.size() > 2 + 3 * count + 1)
      throw TrcFault(l + 1, "there are more than three fields for each marker");
    if (out.frames + 1 > static_cast<size_t>(frames)) {
      throw TrcFault(l + 1, "there are more frames than the " + std::to_string(static_cast<size_t>(frames)) +
                                " of the heading");
    }
    ++out.frames;
    const std::optional<double> time = fields.size() > 1 ? number(fields[1]) : std::nullopt;
    // Half a frame: times are rounded.
    if (time && before && !(std::abs((*time - *before) * out.rate - 1) < 0.5)) {
      throw TrcFault(l + 1, "the time is " + std::string(fields[1]) + " s, and the frame before is not 1 / " +
                                std::string(heading[0]) + " s earlier");
    }
    before = time;
    for (size_t m = 0; m < count; ++m) {
      double x[3] = {};
      int given = 0;
      for (size_t k = 0; k < 3; ++k) {
        const size_t f = 2 + 3 * m + k;
        const std::string_view text = f < fields.size() ? fields[f] : std::string_view();
        if (text.empty() || is_nan(text)) continue;
        const auto value = number(text);
        if (!value || !std::isfinite(*value) || std::abs(*value) > 1e9) {
          throw TrcFault(l + 1, "\"" + std::string(text) + "\" is not a coordinate of " + out.names[m]);
        }
        x[k] = *value, ++given;
      }
      if (given != 0 && given != 3) throw TrcFault(l + 1, out.names[m] + " must have three coordinates");
      const bool seen = given == 3 && (x[0] != 0 || x[1] != 0 || x[2] != 0);
      out.places.push_back(seen ? Vec3{x[0], x[1], x[2]} * unit : Vec3{});
      out.seen.push_back(seen ? 1 : 0);
    }
  }
  if (out.frames != static_cast<size_t>(frames)) {
    throw TrcFault(lines.size(), "the file ends after " + std::to_string(out.frames) + " of " +
                                     std::to_string(static_cast<size_t>(frames)) + " frames");
  }
  return out;
}

}  // namespace truestep
