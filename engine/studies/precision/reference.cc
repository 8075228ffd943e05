#include "engine/studies/precision/reference.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/text/short_number.h"
#include "engine/core/equations/integrator.h"
#include "engine/integrators/table/integrators.h"
#include "engine/studies/scene_variant.h"

namespace truestep {

namespace json = boost::json;

namespace {

struct Attempt {
  Trace trace;
  std::string method;
};

class TraceSearch {
 public:
  TraceSearch(const json::value& document, TraceRequest request, double dt, double cpu_limit,
              const StudyContext& context)
      : document_(document), request_(std::move(request)), dt_(dt), left_(cpu_limit), context_(context) {}

  /// The run with this method, if the system takes it and it finishes in time, with the scene's steps divided
  /// by `parts`.
  std::optional<Attempt> tight(std::string_view method, double tolerance, uint64_t parts) {
    if (!find_integrator(method)) return std::nullopt;
    json::value d = document_;
    set_integrator(d, request_.field.system, method);
    set_tolerance(d, request_.field.system, tolerance);
    return run(std::move(d), parts, std::string(method) + " at tolerance " + short_number(tolerance, 3));
  }
  /// The scene's own method.
  std::optional<Attempt> refined(uint64_t parts) { return run(document_, parts, "the scene's method"); }
  double reached() const { return reached_; }

 private:
  std::optional<Attempt> run(json::value d, uint64_t parts, std::string name) {
    TraceRequest request = request_;
    request.steps_per_sample *= parts;
    request.cpu_limit = left_ / 3;
    set_dt(d, dt_ / static_cast<double>(parts));
    if (parts > 1) name += " at dt / " + std::to_string(parts);
    try {
      Trace t = trace(build_world(d, context_), request, context_);
      left_ -= t.cpu_seconds;
      if (t.end == Trace::End::over_budget) {
        const uint64_t all = request.steps_per_sample * request.samples;
        reached_ = std::max(reached_, static_cast<double>(t.steps) / static_cast<double>(all));
      }
      if (t.end != Trace::End::complete) return std::nullopt;
      return Attempt{std::move(t), std::move(name)};
    } catch (const Error& e) {
      if (e.code() == "cancelled") throw;
      return std::nullopt;  // the method does not serve this system
    }
  }

  const json::value& document_;
  TraceRequest request_;
  double dt_, left_, reached_ = 0;
  const StudyContext& context_;
};

Reference compare(Attempt taken, const Attempt& other) {
  Reference r;
  const double least = rounding_size(taken.trace.values);
  for (size_t i = 0; i < taken.trace.values.size(); ++i)
    r.uncertainty =
        std::max(r.uncertainty, relative_error(other.trace.values[i], taken.trace.values[i], least));
  if (!taken.trace.observed.empty() && !taken.trace.observed.back().empty()) {
    r.observed_difference = std::abs(taken.trace.observed.back()[0] - other.trace.observed.back()[0]);
  }
  r.method = std::move(taken.method);
  r.checked_by = other.method;
  r.trace = std::move(taken.trace);
  return r;
}

}  // namespace

bool steps_matter(const World& world) {
  // Passes besides integration that do not change the motion.
  constexpr std::array<std::string_view, 5> kNeutral = {"integrate", "clock", "hands", "path", "loops"};
  for (const auto& [system, row, number] : world.plan()) {
    if (row.status == PlanRow::Status::runs &&
        std::find(kNeutral.begin(), kNeutral.end(), row.name) == kNeutral.end())
      return true;
  }
  return false;
}

ReferenceSearch find_reference(const json::value& document, const TraceRequest& request,
                               double sample_interval, double cpu_limit, const StudyContext& context,
                               const ReferenceEffort& effort) {
  // Families differ within each list, so two that agree do not share a mistake.
  constexpr std::array<std::string_view, 5> kUsual = {"ias15", "dop853", "radau5", "dopri5", "step_doubling"};
  constexpr std::array<std::string_view, 5> kStiff = {"radau5", "rodas5p", "cvode_bdf", "dop853", "ias15"};
  constexpr std::array<std::string_view, 4> kExplicit = {"dop853", "dopri5", "cvode_adams", "radau5"};
  constexpr std::array<std::string_view, 4> kImplicit = {"cvode_bdf", "rodas5p", "sdirk4", "cvode_adams"};
  TraceSearch search(document, request, sample_interval / static_cast<double>(request.steps_per_sample),
                     cpu_limit, context);
  const bool split = steps_matter(build_world(document, context));
  const uint64_t fine = split ? 8 : 1, coarse = split ? 4 : 1;
  for (const std::string_view name : effort.stiff ? kStiff : kUsual) {
    const double first = effort.first_tolerance;
    auto taken = search.tight(name, first, fine);
    if (!taken) continue;
    // What an explicit method gets through is not stiff, and implicit ones may be far slower.
    const bool easy = find_integrator(name)->kind == Integrator::Kind::explicit_;
    for (const std::string_view check : easy ? kExplicit : kImplicit) {
      if (check == name) continue;
      const auto other = search.tight(check, 10 * first, coarse);
      if (!other) continue;
      // Tightens while time allows and the two get closer; rounding ends that by itself.
      Reference best = compare(std::move(*taken), *other);
      for (double tolerance = 1e-2 * first; tolerance > 0.9e-13; tolerance *= 1e-2) {
        if (best.uncertainty <= effort.enough) break;
        auto tighter = search.tight(name, tolerance, fine);
        const auto again = tighter ? search.tight(check, 10 * tolerance, coarse) : std::nullopt;
        if (!again) break;
        Reference next = compare(std::move(*tighter), *again);
        const bool better = next.uncertainty < best.uncertainty;
        if (better) best = std::move(next);
        // What the steps add is there at every tolerance.
        if (split && !better) break;
      }
      return {std::move(best), 1};
    }
  }
  for (const uint64_t parts : {8, 4, 2}) {
    auto taken = search.refined(parts);
    if (!taken) continue;
    if (const auto other = search.refined(parts / 2)) return {compare(std::move(*taken), *other), 1};
  }
  return {std::nullopt, search.reached()};
}

json::object describe_reference(const Reference& r) {
  return {{"method", r.method},
          {"checked_by", r.checked_by},
          {"uncertainty", std::isfinite(r.uncertainty) ? json::value(r.uncertainty) : json::value(nullptr)}};
}

}  // namespace truestep
