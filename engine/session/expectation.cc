#include "engine/session/expectation.h"

#include <algorithm>
#include <cmath>

namespace truestep {

ExpectedQuantity expected_quantity(const std::string& text) {
  const std::string name = text == "energy.drift" ? "drift(energy.total)" : text;
  for (const auto& [prefix, reduction] :
       {std::pair{"min(", Reduction::min}, {"max(", Reduction::max}, {"drift(", Reduction::drift}}) {
    const std::string_view p = prefix;
    if (name.starts_with(p) && name.ends_with(')')) {
      return {reduction, name.substr(p.size(), name.size() - p.size() - 1)};
    }
  }
  return {Reduction::last, name};
}

namespace {

// Largest |value| among the observables in `name`'s group that share its unit: the terms of a sum set its
// scale, so that a total near zero does not make every drift look large.
double group_scale(const std::string& name, const Observables& values) {
  const size_t dot = name.rfind('.');
  const std::string group = dot == std::string::npos ? name : name.substr(0, dot + 1);
  const auto& rows = values.rows();
  const auto own =
      std::find_if(rows.begin(), rows.end(), [&](const Observation& o) { return o.name == name; });
  double scale = 0;
  for (const Observation& o : rows) {
    const bool akin = dot == std::string::npos ? o.name == name : o.name.starts_with(group);
    if (akin && o.unit == own->unit) scale = std::max(scale, std::abs(o.value));
  }
  return scale;
}

}  // namespace

Expectations::Expectations(const Scene& scene) {
  for (const ExpectParams& e : scene.header.expect) {
    Watched w;
    w.expected = e;
    w.quantity = expected_quantity(e.quantity);
    watched_.push_back(std::move(w));
  }
}

bool Expectations::needs_every_step() const {
  return std::any_of(watched_.begin(), watched_.end(),
                     [](const Watched& w) { return w.quantity.reduction != Reduction::last; });
}

void Expectations::add(const Observables& values) {
  for (Watched& w : watched_) {
    const auto v = values.find(w.quantity.name);
    if (!v) continue;
    if (!w.first) {
      w.first = v;
      w.scale = group_scale(w.quantity.name, values);
    }
    w.value = v;
    w.least = std::min(w.least.value_or(*v), *v);
    w.greatest = std::max(w.greatest.value_or(*v), *v);
    w.deviation = std::max(w.deviation.value_or(0), std::abs(*v - *w.first));
  }
}

std::vector<Verdict> Expectations::verdicts() const {
  std::vector<Verdict> out;
  for (const Watched& w : watched_) {
    Verdict verdict{w.expected, std::nullopt, false, std::nullopt};
    switch (w.quantity.reduction) {
      case Reduction::last:
        verdict.measured = w.value;
        break;
      case Reduction::min:
        verdict.measured = w.least;
        break;
      case Reduction::max:
        verdict.measured = w.greatest;
        break;
      case Reduction::drift:
        if (!w.deviation) break;
        verdict.drift_scale = w.scale;
        verdict.measured = *w.deviation / (w.scale > 0 ? w.scale : 1);
        break;
    }
    if (const auto m = verdict.measured) {
      const ExpectParams& e = w.expected;
      verdict.met = std::isfinite(*m) && (!e.min || *m >= *e.min) && (!e.max || *m <= *e.max) &&
                    (!e.equals || std::abs(*m - *e.equals) <= e.tolerance);
    }
    out.push_back(std::move(verdict));
  }
  return out;
}

}  // namespace truestep
