#include "engine/studies/reference.h"

#include <array>
#include <charconv>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/core/integrator.h"
#include "engine/studies/scene_variant.h"

namespace truestep {

namespace json = boost::json;

namespace {

std::string short_number(double v) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, v, std::chars_format::general, 3).ptr};
}

struct Attempt {
  Trace trace;
  std::string method;
};

class Search {
 public:
  Search(const json::value& document, TraceRequest request, double dt, double cpu_limit,
         const StudyContext& context)
      : document_(document), request_(std::move(request)), dt_(dt), left_(cpu_limit), context_(context) {}

  /// The run with this method, when the system takes it and it gets through in time.
  std::optional<Attempt> tight(std::string_view method, double tolerance) {
    if (!find_integrator(method)) return std::nullopt;
    json::value d = document_;
    set_integrator(d, request_.field.system, method);
    set_tolerance(d, request_.field.system, tolerance);
    return run(d, dt_, std::string(method) + " at tolerance " + short_number(tolerance));
  }
  /// The scene's own method with a step divided by `parts`.
  std::optional<Attempt> refined(uint64_t parts) {
    const uint64_t before = request_.steps_per_sample;
    request_.steps_per_sample = before * parts;
    auto a = run(document_, dt_ / static_cast<double>(parts),
                 "the scene's method at dt / " + std::to_string(parts));
    request_.steps_per_sample = before;
    return a;
  }

 private:
  std::optional<Attempt> run(json::value d, double dt, std::string name) {
    set_dt(d, dt);
    try {
      const World world = build_world(d);
      request_.cpu_limit = left_ / 3;
      Trace t = trace(world, request_, context_);
      left_ -= t.cpu_seconds;
      if (t.end != Trace::End::complete) return std::nullopt;
      return Attempt{std::move(t), std::move(name)};
    } catch (const Error& e) {
      if (e.code() == "cancelled") throw;
      return std::nullopt;  // the method does not serve this system
    }
  }

  const json::value& document_;
  TraceRequest request_;
  double dt_, left_;
  const StudyContext& context_;
};

Reference compare(Attempt taken, const Attempt& other) {
  Reference r;
  for (size_t i = 0; i < taken.trace.values.size(); ++i)
    r.uncertainty = std::max(r.uncertainty, relative_error(other.trace.values[i], taken.trace.values[i]));
  r.method = std::move(taken.method);
  r.checked_by = other.method;
  r.trace = std::move(taken.trace);
  return r;
}

}  // namespace

Reference find_reference(const json::value& document, const TraceRequest& request, double sample_interval,
                         double cpu_limit, const StudyContext& context) {
  // Families differ within each list, so two that agree do not share a mistake.
  constexpr std::array<std::string_view, 5> kTaken = {"ias15", "dop853", "radau5", "dopri5", "step_doubling"};
  constexpr std::array<std::string_view, 5> kChecks = {"dop853", "radau5", "cvode_bdf", "cvode_adams",
                                                       "dopri5"};
  Search search(document, request, sample_interval / static_cast<double>(request.steps_per_sample), cpu_limit,
                context);
  for (const std::string_view name : kTaken) {
    auto taken = search.tight(name, 1e-7);
    if (!taken) continue;
    for (const std::string_view check : kChecks) {
      if (check == name) continue;
      const auto other = search.tight(check, 1e-6);
      if (!other) continue;
      // Tighter while the time allows and the two come closer; rounding ends that by itself.
      Reference best = compare(std::move(*taken), *other);
      for (const double tolerance : {1e-9, 1e-11, 1e-13}) {
        auto tighter = search.tight(name, tolerance);
        const auto again = tighter ? search.tight(check, 10 * tolerance) : std::nullopt;
        if (!again) break;
        Reference next = compare(std::move(*tighter), *again);
        if (next.uncertainty < best.uncertainty) best = std::move(next);
      }
      return best;
    }
  }
  for (const uint64_t parts : {8, 4, 2}) {
    auto fine = search.refined(parts);
    if (!fine) continue;
    if (const auto coarse = search.refined(parts / 2)) return compare(std::move(*fine), *coarse);
  }
  throw Error("study_failed",
              "no method reaches a reference solution within the time budget; shorten the horizon");
}

json::object describe_reference(const Reference& r) {
  return {{"method", r.method},
          {"checked_by", r.checked_by},
          {"uncertainty", std::isfinite(r.uncertainty) ? json::value(r.uncertainty) : json::value(nullptr)}};
}

}  // namespace truestep
