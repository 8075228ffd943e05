#include "engine/systems/skeleton/markers.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/geometry/read/trc.h"
#include "engine/kernels/animation/marker_fit.h"
#include "engine/kernels/animation/triangulation.h"

namespace truestep::skeleton {

using namespace animation;

namespace {

[[noreturn]] void refuse(const std::string& pointer, const std::string& why, const std::string& value = "",
                         const std::string& allowed = "") {
  throw Error("scene_invalid", why, {pointer, "bad_markers", why, value, allowed, "", ""});
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> out;
  for (size_t at = 0; at < line.size();) {
    const size_t first = line.find_first_not_of(" \t\r", at);
    if (first == std::string_view::npos) break;
    const size_t end = std::min(line.find_first_of(" \t\r", first), line.size());
    out.push_back(line.substr(first, end - first));
    at = end;
  }
  return out;
}

template <class T>
bool read(std::string_view s, T& x) {
  const auto [end, fault] = std::from_chars(s.data(), s.data() + s.size(), x);
  return fault == std::errc() && end == s.data() + s.size();
}

/// Reads lines "frame camera marker u v".
MarkerTracks triangulated(const MarkersDef& def, const std::string& where, MarkerReport& report) {
  constexpr double kMostPixels = 1e9;
  constexpr uint32_t kMostFrames = 1'000'000;
  MarkerTracks out;
  out.rate = def.rate;
  for (const PlacementDef& p : def.placements) out.names.push_back(p.marker);
  std::vector<PinholeCamera> cameras;
  for (const CameraDef& c : def.cameras)
    cameras.push_back(camera_looking_at(c.position, c.target, c.up, c.focal, c.middle_u, c.middle_v));
  struct Seen {
    uint32_t frame = 0;
    size_t marker = 0;
    Sighting sighting;
  };
  std::vector<Seen> all;
  for (size_t l = 0; l < def.images.size(); ++l) {
    const std::string at = where + "/images/" + std::to_string(l);
    const auto words = words_of(def.images[l]);
    if (words.empty()) continue;
    Seen s;
    double u = 0, v = 0;
    if (words.size() != 5 || !read(words[0], s.frame) || !read(words[3], u) || !read(words[4], v)) {
      refuse(at, "a line is frame, camera, marker, u and v", def.images[l], "\"0 left wrist 512.3 300.1\"");
    }
    if (!(std::abs(u) <= kMostPixels && std::abs(v) <= kMostPixels) || s.frame >= kMostFrames)
      refuse(at, "a number is too large", def.images[l]);
    const auto camera = std::ranges::find(def.cameras, words[1], &CameraDef::name);
    if (camera == def.cameras.end()) refuse(at, "there is no camera \"" + std::string(words[1]) + "\"");
    const auto marker = std::ranges::find(out.names, words[2]);
    if (marker == out.names.end()) refuse(at, "there is no marker \"" + std::string(words[2]) + "\"");
    s.sighting = {static_cast<uint32_t>(camera - def.cameras.begin()), {u, v}};
    s.marker = static_cast<size_t>(marker - out.names.begin());
    out.frames = std::max<size_t>(out.frames, s.frame + 1);
    all.push_back(s);
  }
  if (all.empty()) refuse(where + "/images", "there are no images");
  std::ranges::stable_sort(all, [](const Seen& a, const Seen& b) {
    return a.frame != b.frame ? a.frame < b.frame : a.marker < b.marker;
  });
  // Every frame is stored, empty ones too.
  if (static_cast<double>(out.frames) * static_cast<double>(out.names.size()) > 2e7)
    refuse(where + "/images", "there are too many frames");
  out.places.resize(out.frames * out.names.size()), out.seen.resize(out.places.size());
  const auto groups = [&](auto&& take) {
    std::vector<Sighting> group;
    for (size_t i = 0; i < all.size();) {
      size_t end = i;
      group.clear();
      for (; end < all.size() && all[end].frame == all[i].frame && all[end].marker == all[i].marker; ++end)
        group.push_back(all[end].sighting);
      take(all[i].frame * out.names.size() + all[i].marker, group);
      i = end;
    }
  };
  std::vector<Triangulated> plain;
  std::vector<uint32_t> sightings;
  groups([&](size_t, const std::vector<Sighting>& group) {
    const auto found = triangulate(cameras, group);
    if (found) plain.push_back(*found), sightings.push_back(static_cast<uint32_t>(group.size()));
  });
  const double noise = picture_noise(plain, sightings);
  double sum = 0, count = 0;
  groups([&](size_t row, const std::vector<Sighting>& group) {
    const auto point = triangulate_agreed(cameras, group, noise);
    // A single camera gives no point, and no outlier either.
    if (group.size() > 1) report.outliers += static_cast<double>(group.size()) - (point ? point->used : 0);
    if (!point) return;
    out.places[row] = point->found.place, out.seen[row] = 1;
    sum += point->found.residual * point->found.residual, ++count;
  });
  report.residual = count > 0 ? std::sqrt(sum / count) : 0;
  return out;
}

/// The first pose: the best of four turns about the vertical, with the mean of the markers where it was
/// observed.
void start(const Model& model, std::span<const MarkerPlacement> markers, std::span<const Vec3> places,
           std::span<const uint8_t> seen, std::vector<JointMotion>& motion, MarkerWork& work,
           std::vector<uint8_t>& known) {
  std::vector<JointMotion> best;
  double least = HUGE_VAL;
  std::vector<Pose> poses(model.joints.size());
  for (int quarter = 0; quarter < 4; ++quarter) {
    std::vector<JointMotion> tried(model.joints.size());
    for (size_t j = 0; j < tried.size(); ++j) apply_limits(model.joints[j], tried[j]);
    if (model.joints[0].kind == JointKind::ball) {
      const Quat rest = model.joints[0].rest.orientation;
      tried[0].turn = conjugate(rest) * turn_about({0, 1, 0}, 1.5707963267948966 * quarter) * rest;
    }
    forward_kinematics(model.joints, tried, {}, poses);
    Vec3 off;
    double count = 0;
    for (size_t i = 0; i < markers.size(); ++i) {
      if (!seen[i]) continue;
      const Pose& p = poses[markers[i].joint];
      off += places[i] - p.position - rotate(p.orientation, markers[i].point), ++count;
    }
    if (count > 0) tried[0].shift = rotate(conjugate(model.joints[0].rest.orientation), off / count);
    const MarkerFit fit = fit_markers(model.joints, markers, places, seen, tried, known, work);
    // A wrong pose may reject the markers that contradict it: then the median is used.
    const double score = fit.outliers > 0 ? std::max(fit.error, 1.732 * fit.spread) : fit.error;
    if (score < least) least = score, best = tried;
  }
  motion = best;
}

/// Interpolates joints in frames that determined nothing about them.
void fill(Recording& r, const std::vector<uint8_t>& known) {
  const size_t n = r.joints.size();
  for (size_t j = 0; j < n; ++j) {
    size_t before = SIZE_MAX;
    for (size_t f = 0; f < r.frames; ++f) {
      if (!known[f * n + j]) continue;
      const size_t first = before == SIZE_MAX ? 0 : before + 1;
      for (size_t k = first; k < f; ++k) {
        const size_t from = before == SIZE_MAX ? f : before;
        const double s =
            before == SIZE_MAX ? 0 : static_cast<double>(k - before) / static_cast<double>(f - before);
        r.turns[k * n + j] =
            slerp(r.turns[from * n + j], nearer(r.turns[from * n + j], r.turns[f * n + j]), s);
        r.values[k * n + j] = r.values[from * n + j] + (r.values[f * n + j] - r.values[from * n + j]) * s;
        r.shifts[k * n + j] = r.shifts[from * n + j] + (r.shifts[f * n + j] - r.shifts[from * n + j]) * s;
      }
      before = f;
    }
    for (size_t f = before == SIZE_MAX ? r.frames : before + 1; f < r.frames; ++f) {
      r.turns[f * n + j] = r.turns[before * n + j], r.values[f * n + j] = r.values[before * n + j];
      r.shifts[f * n + j] = r.shifts[before * n + j];
    }
  }
}

}  // namespace

Recording recording_of(const MarkersDef& def, double scale, const Model& model, const std::string& where,
                       MarkerReport& report) {
  MarkerTracks tracks;
  if (!def.trc.empty()) {
    try {
      tracks = read_trc(def.trc);
    } catch (const TrcFault& f) {
      refuse(where + "/trc/" + std::to_string(std::min(f.line, def.trc.size()) - 1), f.what());
    }
  } else {
    tracks = triangulated(def, where, report);
  }
  const size_t count = def.placements.size(), n = model.joints.size();
  std::vector<MarkerPlacement> markers;
  std::vector<size_t> track;
  for (size_t k = 0; k < count; ++k) {
    const PlacementDef& p = def.placements[k];
    const std::string at = where + "/placements/" + std::to_string(k);
    const auto joint = model.find(p.joint);
    if (!joint) refuse(at + "/joint", "there is no joint \"" + p.joint + "\"", p.joint);
    const auto name = std::ranges::find(tracks.names, p.marker);
    if (name == tracks.names.end())
      refuse(at + "/marker", "the file has no marker \"" + p.marker + "\"", p.marker);
    markers.push_back({static_cast<uint32_t>(*joint), p.point});
    track.push_back(static_cast<size_t>(name - tracks.names.begin()));
  }
  Recording out;
  out.frames = tracks.frames, out.frame_time = 1 / tracks.rate;
  for (size_t j = 0; j < n; ++j) {
    const Joint& joint = model.joints[j];
    out.joints.push_back(
        {model.ids[j], joint.parent, joint.rest.position, joint.rest.orientation, {}, j == 0});
  }
  std::vector<JointMotion> motion(n);
  std::vector<Vec3> places(count);
  std::vector<uint8_t> seen(count), known(n), all_known;
  MarkerWork work;
  double squares = 0, markers_seen = 0, count_all = 0;
  bool started = false;
  for (size_t f = 0; f < out.frames; ++f) {
    size_t now = 0;
    for (size_t k = 0; k < count; ++k) {
      const size_t row = f * tracks.names.size() + track[k];
      places[k] = tracks.places[row] * scale, seen[k] = tracks.seen[row], now += seen[k];
    }
    // Three points determine the pose of a body.
    std::ranges::fill(known, uint8_t{0});
    if (now >= 3) {
      if (!started) start(model, markers, places, seen, motion, work, known), started = true;
      const MarkerFit fit = fit_markers(model.joints, markers, places, seen, motion, known, work);
      const auto counted = static_cast<double>(now - fit.outliers);
      squares += fit.error * fit.error * counted, count_all += counted;
      markers_seen += static_cast<double>(now), report.outliers += static_cast<double>(fit.outliers);
    }
    for (size_t j = 0; j < n; ++j) {
      out.turns.push_back(motion[j].turn), out.shifts.push_back(motion[j].shift),
          out.values.push_back(motion[j].value);
    }
    all_known.insert(all_known.end(), known.begin(), known.end());
  }
  if (!started) refuse(where, "no frame shows three markers");
  fill(out, all_known);
  report.error = count_all > 0 ? std::sqrt(squares / count_all) : 0;
  report.seen = markers_seen / (static_cast<double>(count) * static_cast<double>(out.frames));
  return out;
}

}  // namespace truestep::skeleton
