#include "engine/session/expectation.h"

#include <algorithm>
#include <cmath>

namespace truestep {

Expectations::Expectations(const Scene& scene) {
  for (const ExpectParams& e : scene.header.expect) {
    Watched w;
    w.expected = e;
    w.name = e.quantity == "energy.drift" ? "drift(energy.total)" : e.quantity;
    for (const auto& [prefix, reduction] :
         {std::pair{"min(", Reduction::min}, {"max(", Reduction::max}, {"drift(", Reduction::drift}}) {
      const std::string_view p = prefix;
      if (w.name.starts_with(p) && w.name.ends_with(')')) {
        w.name = w.name.substr(p.size(), w.name.size() - p.size() - 1);
        w.reduction = reduction;
        break;
      }
    }
    watched_.push_back(std::move(w));
  }
}

bool Expectations::needs_every_step() const {
  return std::any_of(watched_.begin(), watched_.end(),
                     [](const Watched& w) { return w.reduction != Reduction::last; });
}

void Expectations::add(const Observables& values) {
  for (Watched& w : watched_) {
    const auto v = values.find(w.name);
    if (!v) continue;
    if (!w.first) {
      w.first = v;
      // The parts of a sum set its scale: a total energy near zero must not make every drift look large.
      const size_t dot = w.name.rfind('.');
      for (const Observation& o : values.rows()) {
        if (dot != std::string::npos && o.name.starts_with(w.name.substr(0, dot + 1))) {
          w.scale = std::max(w.scale, std::abs(o.value));
        }
      }
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
    Verdict verdict{w.expected, std::nullopt, false};
    switch (w.reduction) {
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
        if (w.deviation) verdict.measured = *w.deviation / std::max({std::abs(*w.first), w.scale, 1e-300});
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
