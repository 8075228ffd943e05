// Three systems known only to tests, one per kind of part: streams, recordings, pictures, probes and
// snapshots handle them through their parts alone.
#pragma once
#include <cmath>

#include "engine/core/outputs.h"
#include "engine/scene/scene.h"
#include "engine/session/world/world.h"

namespace truestep::testing {

/// Rows whose numbers are first + row + step; every step adds 1.
class PartSystem : public System {
 public:
  explicit PartSystem(PartInfo part) { set_parts({std::move(part)}); }

  State initial_state() const override {
    State s;
    const PartInfo& part = parts()[0];
    for (size_t f = 0; f < part.fields.size(); ++f) {
      const FieldInfo& info = part.fields[f];
      const auto c = s.add({info.name, info.unit, Scalar::f64, info.width, Role::internal}, part.max_rows);
      for (size_t k = 0; k < s.f64(c).size(); ++k)
        s.f64(c)[k] = 100.0 * static_cast<double>(f) + static_cast<double>(k);
    }
    return s;
  }
  void step(State& s, const StepInput&) const override {
    for (size_t f = 0; f < parts()[0].fields.size(); ++f) {
      for (double& x : s.f64(static_cast<State::Column>(f))) x += 1;
    }
  }
  void observe(const State&, double, Observables&) const override {}
  void apply(State&, const Command&) const override {}
  std::vector<PlanRow> plan() const override { return {}; }
  FieldView field(const State& s, size_t, size_t f, std::vector<double>&) const override {
    const auto c = static_cast<State::Column>(f);
    return {s.f64(c).data(), Scalar::f64, s.rows(c), s.info(c).width};
  }
  void draw(const State&, double, Wish wishes, Drawing& out) const override {
    if (wants(wishes, Wish::constant)) out.parts.emplace_back().point_radius = 0.4;
  }
};

inline PartInfo points_part() {
  PartInfo p;
  p.fields = {{"where", "m", Scalar::f64, 3, Meaning::position}, {"mass", "kg"}};
  p.max_rows = 5;
  return p;
}
inline PartInfo grid_part() {
  PartInfo p;
  p.kind = PartInfo::Kind::grid;
  p.fields = {{"heat", "K"}, {"flow", "m/s", Scalar::f64, 2}};
  p.lattice = {{4, 3, 1}, {1, 2, 0}, {0.5, 0.25, 1}, Lattice::Centring::cells};
  p.max_rows = p.lattice.rows();
  return p;
}
inline PartInfo values_part() {
  PartInfo p;
  p.kind = PartInfo::Kind::values;
  p.fields = {{"load", "N"}};
  p.max_rows = 7;
  return p;
}

/// A world of one such system, with `header` (JSON members) beside it.
inline std::shared_ptr<const World> world_of_part(PartInfo (*part)(), const std::string& header) {
  static PartInfo (*made)() = nullptr;
  made = part;
  static const Outputs kNothing{};
  static const CatalogueRow kRow{"part",
                                 "tests",
                                 "a part",
                                 find_system_type("oscillator")->table,
                                 [](const void*, const BuildContext&) -> std::unique_ptr<const System> {
                                   return std::make_unique<PartSystem>(made());
                                 },
                                 [](const void*) { return Cost{.elements = 1}; },
                                 {},
                                 "",
                                 &kNothing};
  Scene scene = parse_scene(R"({"time": {"dt": 0.1, "duration": 1}, )" + header +
                            R"("systems": [{"type": "oscillator", "id": "p"}]})");
  scene.systems[0].row = &kRow;
  return std::make_shared<const World>(std::move(scene));
}

}  // namespace truestep::testing
