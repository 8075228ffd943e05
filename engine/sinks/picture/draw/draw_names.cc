#include "engine/sinks/picture/draw/draw_names.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "engine/session/world/frame_values.h"

namespace truestep {

namespace {

struct TimeUnit {
  double least;  ///< s of the run from which on it is used
  double size;   ///< s
  const char* name;
};

// As in web/src/ui/time_text.ts.
constexpr std::array kUnits{TimeUnit{6.3e7, 31557600, "years"},
                            TimeUnit{2e5, 86400, "days"},
                            TimeUnit{1e-2, 1, "s"},
                            TimeUnit{1e-3, 1e-3, "ms"},
                            TimeUnit{1e-6, 1e-6, "µs"},
                            TimeUnit{1e-9, 1e-9, "ns"},
                            TimeUnit{0, 1e-12, "ps"}};

}  // namespace

void add_probe_labels(DrawList& list, const World& world, const Frame& frame) {
  for (const ProbeParams& probe : world.scene().header.probes) {
    if (probe.at || probe.rows != ProbeParams::Rows::one) continue;
    for (size_t p = 0; p < world.parts().size(); ++p) {
      const auto& part = world.parts()[p];
      if (part.id != probe.system || part.info().kind != PartInfo::Kind::points) continue;
      const FrameValues at(frame, p, part.info().find(Meaning::position));
      const auto rows = static_cast<int64_t>(at.rows());
      const int64_t row = probe.index < 0 ? rows + probe.index : probe.index;
      if (row < 0 || row >= rows || !at.has(static_cast<size_t>(row), 3)) continue;
      const size_t k = 3 * static_cast<size_t>(row);
      std::string name = probe.id;
      std::replace(name.begin(), name.end(), '_', ' ');
      list.labels.push_back({name,
                             {at.at(k), at.at(k + 1), at.at(k + 2)},
                             DrawLabel::Side::beside,
                             {},
                             frame.constant->parts[p].point_radius});
    }
  }
}

std::string time_text(double time, double duration) {
  const double run = std::max(std::abs(time), std::isfinite(duration) ? duration : 0);
  const TimeUnit* unit = &kUnits[2];
  if (run > 0) {
    unit = std::find_if(kUnits.begin(), kUnits.end(), [&](const TimeUnit& u) { return run >= u.least; });
  }
  std::array<char, 64> text{};
  const double value = time / unit->size;
  const bool usual = std::abs(value) < 1e6;
  const int digits = unit->size == 1 ? 3 : run / unit->size < 100 ? 2 : 1;
  std::snprintf(text.data(), text.size(), usual ? "t = %.*f %s" : "t = %.*g %s", usual ? digits : 4, value,
                unit->name);
  return text.data();
}

}  // namespace truestep
