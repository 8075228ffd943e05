// What equations give out: states by their names, tracers or what is plotted, invariants and events.
#include <algorithm>
#include <cmath>

#include "engine/core/outputs/outputs_of.h"
#include "engine/systems/ode/ode.h"

namespace truestep::ode {

using C = OdeColumns;

struct Ode::Invariant {
  double value, drift;
};
struct Ode::Happened {
  double count;
  std::optional<double> resting = {};
};

namespace {

/// Longer arrays are available only as fields.
constexpr size_t kObservedElements = 16;

struct Number {
  double value;
};
struct Stop {
  double stopped, time;
};
Stop stop(const Ode&, const State& s, double t) {
  const bool stopped = s.f64(C::kStopped)[0] != 0;
  return {stopped ? 1.0 : 0.0, stopped ? s.f64(C::kStopped)[1] : t};
}

struct Extent {
  double least = HUGE_VAL, greatest = -HUGE_VAL, mean = 0;
};
Extent extent(const Ode&, const State& s, double, size_t axis) {
  const auto x = s.f64(C::kTracers);
  Extent out;
  double sum = 0;
  for (size_t i = axis; i < x.size(); i += 3)
    out.least = std::min(out.least, x[i]), out.greatest = std::max(out.greatest, x[i]), sum += x[i];
  const size_t points = x.size() / 3;
  out.mean = sum / static_cast<double>(points);
  return out;
}

/// One of the counters of the integrator.
template <OdeWork which>
double work(const State& s) {
  return static_cast<double>(s.span<uint64_t>(C::kWork)[which]);
}
struct Work {
  double steps, rejected, rates, jacobians;
};
Work work_of(const Ode&, const State& s, double) {
  return {work<kOdeSteps>(s), work<kOdeRejected>(s), work<kOdeRates>(s), work<kOdeJacobians>(s)};
}

}  // namespace

const OutputTable& Ode::outputs() {
  const auto names = [](std::vector<Observed> Ode::*which) {
    return [which](const Ode& o) {
      std::vector<std::string> out;
      for (const Observed& n : o.*which) out.push_back(n.name);
      return out;
    };
  };
  const auto values = [](std::vector<Observed> Ode::*which) {
    return [which](const Ode& o, const State& s, double, size_t k) {
      return Number{s.f64(C::kStates)[(o.*which)[k].place]};
    };
  };
  const auto traced = [](const Ode& o) { return o.def_.tracers.has_value(); };
  static const OutputTable kTable =
      OutputsOf<Ode>(
          "an element of an array state (a number state has only row 0); for position a tracer, or a drawn "
          "point followed by the past ones of its trail")
          .part("",
                [](const Ode& o) {
                  std::optional<PartInfo> points;
                  if (o.rows_ > 0) points = points_part(o.rows_), points->trail = o.trail_;
                  return points;
                })
          .field(
              {"position", "m", Scalar::f64, 3, Meaning::position},
              [](const Ode& o, const State& s, const FieldAt&) -> const void* {
                return s.f64(o.def_.tracers ? C::kTracers : C::kTrail).data();
              },
              "tracers, or the points of plot and their trails")
          .field(
              {"tag", "1"},
              [](const Ode& o, const State&, const FieldAt&) -> const void* { return o.tags_.data(); },
              "tracers: initial position along x, 0 to 1")
          .field_when([](const Ode& o) { return !o.tags_.empty(); })
          .part("", &Ode::state_parts)
          .field(
              {"<state>", "1"},
              [](const Ode& o, const State& s, const FieldAt& at) -> const void* {
                const auto& places = o.model_.states[o.groups_[at.part][at.member]].places;
                at.scratch.resize(places.size());
                for (size_t k = 0; k < places.size(); ++k) at.scratch[k] = s.f64(C::kStates)[places[k]];
                return at.scratch.data();
              },
              "a state by its name, an array with one row per element")
          .field_each([](const Ode& o, size_t part) {
            std::vector<std::string> out;
            for (const size_t k : o.groups_[part]) out.push_back(o.model_.states[k].name);
            return out;
          })
          .measured_each(names(&Ode::numbers_), values(&Ode::numbers_),
                         {{"<state>", "1", &Number::value, "value of a number state"}})
          .measured_each(names(&Ode::elements_), values(&Ode::elements_),
                         {{"<state>.<k>", "1", &Number::value, "element k of an array of at most 16"}})
          .measured_each([](const Ode& o) { return o.model_.invariant_names; }, &Ode::invariant,
                         {{"<invariant>", "1", &Invariant::value, "value of an invariant"},
                          {"<invariant>.drift", "1", &Invariant::drift,
                           "change since the start, relative to the start; absolute where that is 0"}})
          .measured_each(
              [](const Ode& o) {
                std::vector<std::string> out;
                for (const OdeModel::Event& e : o.model_.events) out.push_back(e.name);
                return out;
              },
              &Ode::happened,
              {{"events.<name>", "1", &Happened::count, "number of times the event has happened"},
               {"events.<name>.resting", "1", &Happened::resting,
                "if it can come to rest: 1 while it rests"}})
          .measured(stop,
                    {{"stopped", "1", &Stop::stopped, "1 once an event has stopped the system"},
                     {"stopped.time", "s", &Stop::time, "time of the stop; until then the present time"}})
          .when([](const Ode& o) { return !o.model_.events.empty(); })
          .measured([](const Ode&, const State& s,
                       double) { return Number{static_cast<double>(s.rows(C::kTracers))}; },
                    {{"tracers.count", "1", &Number::value, "number of tracers"}})
          .when(traced)
          .measured_each(
              [](const Ode&) {
                return std::vector<std::string>{"x", "y", "z"};
              },
              extent,
              {{"tracers.<axis>.min", "m", &Extent::least, "smallest coordinate along x, y or z"},
               {"tracers.<axis>.max", "m", &Extent::greatest, "largest"},
               {"tracers.<axis>.mean", "m", &Extent::mean, "mean"}})
          .when(traced)
          .measured(work_of,
                    {{"integrator.steps", "1", &Work::steps, "internal steps taken since the start"},
                     {"integrator.rejected", "1", &Work::rejected, "rejected internal steps"},
                     {"integrator.rates", "1", &Work::rates, "evaluations of the right-hand sides"},
                     {"integrator.jacobians", "1", &Work::jacobians, "evaluations of their derivatives"}})
          .when([](const Ode& o) { return o.method_ != nullptr; })
          .build();
  return kTable;
}

const Outputs& ode_outputs() {
  static const Outputs kDescribed = Ode::outputs().described();
  return kDescribed;
}

void Ode::sort_states() {
  for (size_t k = 0; k < model_.states.size(); ++k) {
    const OdeModel::Named& n = model_.states[k];
    auto at = std::ranges::find_if(groups_, [&](const std::vector<size_t>& g) {
      return model_.states[g[0]].places.size() == n.places.size();
    });
    if (at == groups_.end()) at = groups_.insert(at, std::vector<size_t>{});
    at->push_back(k);
    if (n.form == NamedNumbers::Form::number) {
      numbers_.push_back({n.name, n.places[0]});
    } else if (n.places.size() <= kObservedElements) {
      for (size_t i = 0; i < n.places.size(); ++i)
        elements_.push_back({n.name + "." + std::to_string(i), n.places[i]});
    }
  }
}

std::vector<PartInfo> Ode::state_parts() const {
  std::vector<PartInfo> out;
  for (const std::vector<size_t>& group : groups_) {
    const OdeModel::Named& first = model_.states[group[0]];
    // Without points, the first of them is the main part.
    const bool main = out.empty() && rows_ == 0;
    out.push_back(values_part(first.places.size()));
    if (!main) out.back().name = first.places.size() == 1 ? "states" : first.name;
  }
  return out;
}

Ode::Invariant Ode::invariant(const State& s, double t, size_t k) const {
  OdeEvaluation evaluate(model_.invariants);
  evaluate.set_parameters(s.f64(C::kParameters));
  std::vector<double> now(model_.invariants.outputs());
  const auto y = s.f64(C::kStates);
  evaluate(t, y.data(), y.size(), model_.parameter_values.size(), now.data());
  const double start = s.f64(C::kInvariantsAtStart)[k];
  return {now[k], std::abs(now[k] - start) / (start != 0 ? std::abs(start) : 1)};
}

Ode::Happened Ode::happened(const State& s, double, size_t event) const {
  Happened out{static_cast<double>(s.span<uint64_t>(C::kEventCounts)[event])};
  if (model_.contacts.empty() || model_.events[event].def.when.empty()) return out;
  const auto guard = static_cast<size_t>(
      std::count_if(model_.events.begin(), model_.events.begin() + static_cast<ptrdiff_t>(event),
                    [](const OdeModel::Event& e) { return !e.def.when.empty(); }));
  if (!model_.contacts[guard].places.empty())
    out.resting = s.span<int32_t>(C::kResting)[guard] != 0 ? 1.0 : 0.0;
  return out;
}

}  // namespace truestep::ode
