#include "engine/session/expectation.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/math/expression/names.h"

namespace truestep {

namespace {

constexpr const char* kPotential = "energy.potential";

bool of_energy(Reduction r) {
  return r == Reduction::gain || r == Reduction::loss;
}

// The observables whose magnitudes set the scale of a drift begin with this.
std::string group_of(const std::string& name) {
  const size_t dot = name.rfind('.');
  return dot == std::string::npos ? name : name.substr(0, dot + 1);
}

// Largest |value| among the observables in `name`'s group that share its unit: the terms of a sum set its
// scale, so that a total near zero does not make every drift look large.
double group_scale(const std::string& name, const Observables& values) {
  const std::string group = group_of(name);
  const auto& rows = values.rows();
  const auto own =
      std::find_if(rows.begin(), rows.end(), [&](const Observation& o) { return o.name == name; });
  double scale = 0;
  for (const Observation& o : rows) {
    const bool akin = group == name ? o.name == name : o.name.starts_with(group);
    if (akin && o.unit == own->unit) scale = std::max(scale, std::abs(o.value));
  }
  return scale;
}

ExpectedQuantity read_quantity(const std::string& text, size_t index) {
  try {
    return ExpectedQuantity(text);
  } catch (const ExpressionFault& fault) {
    throw Error("scene_invalid", "a quantity cannot be read",
                {{"/expect/" + std::to_string(index) + "/quantity", "bad_expression", describe(fault, text),
                  '"' + text.substr(0, 80) + '"', "", fault.did_you_mean, ""}});
  }
}

// Whether t lies in the window of an expectation or of a track, up to rounding.
template <class Windowed>
bool within(const Windowed& w, double t) {
  constexpr double kRounding = 1e-9;
  return (!w.from || t >= *w.from - kRounding * std::abs(*w.from)) &&
         (!w.until || t <= *w.until + kRounding * std::abs(*w.until));
}

}  // namespace

Expectations::Expectations(const Scene& scene) {
  for (const ExpectParams& e : scene.header.expect) {
    Watched w{e, read_quantity(e.quantity, watched_.size()), {}};
    w.seen.resize(w.quantity.tracks().size());
    watched_.push_back(std::move(w));
  }
}

bool Expectations::needs_every_step() const {
  return std::any_of(watched_.begin(), watched_.end(), [](const Watched& w) {
    return w.expected.until || std::any_of(w.quantity.tracks().begin(), w.quantity.tracks().end(),
                                           [](const auto& t) { return t.reduction != Reduction::last; });
  });
}

bool Expectations::wants(std::string_view observable) const {
  for (const Watched& w : watched_) {
    for (const QuantityTrack& t : w.quantity.tracks()) {
      if (of_energy(t.reduction) && observable == kPotential) return true;
      for (const std::string& name : t.term.names()) {
        if (observable == name) return true;
        if (t.reduction == Reduction::drift && observable.starts_with(group_of(name))) return true;
      }
    }
  }
  return false;
}

void Expectations::add_to(Seen& s, const QuantityTrack& track, const Observables& values, double t) {
  const auto v = within(track, t) ? track.term.value(values, t) : std::nullopt;
  if (!v) return;
  if (of_energy(track.reduction)) {
    const auto potential = values.find(kPotential);
    if (!potential) return;
    if (!s.first_potential) s.first_potential = potential;
    s.lowest_potential = std::min(s.lowest_potential.value_or(*potential), *potential);
  }
  if (!s.first) {
    s.first = v;
    if (track.reduction == Reduction::drift) s.scale = group_scale(track.term.names()[0], values);
  }
  s.value = v;
  s.least = std::min(s.least.value_or(*v), *v);
  s.greatest = std::max(s.greatest.value_or(*v), *v);
  s.largest = std::max(s.largest, std::abs(*v));
  s.deviation = std::max(s.deviation, std::abs(*v - *s.first));
  s.sum += *v, ++s.count;
}

void Expectations::add(const Observables& values, double t) {
  for (Watched& w : watched_) {
    if (!within(w.expected, t)) continue;
    for (size_t i = 0; i < w.seen.size(); ++i) add_to(w.seen[i], w.quantity.tracks()[i], values, t);
    w.t = t;
  }
}

std::optional<double> Expectations::reduced(const Seen& s, Reduction reduction, double given) {
  if (!s.first) return std::nullopt;
  switch (reduction) {
    case Reduction::last:
      return s.value;
    case Reduction::start:
      return s.first;
    case Reduction::min:
      return s.least;
    case Reduction::max:
      return s.greatest;
    case Reduction::mean:
      return s.sum / s.count;
    case Reduction::largest:
      return s.largest;
    case Reduction::change:
      return s.deviation;
    case Reduction::drift:
      return s.deviation / (s.scale > 0 ? s.scale : 1);
    case Reduction::gain:
    case Reduction::loss: {
      const double kinetic = *s.first - *s.first_potential;
      const double work = kinetic + (*s.first_potential - *s.lowest_potential) + given;
      // Positions are rounded, to 24 bits in systems of single precision; a body at rest has no energy at
      // work to compare that with.
      constexpr double kSingle = 1.0 / (1 << 24);
      const double rounding = 1e-12 + kSingle * std::abs(*s.first_potential);
      const double amount =
          reduction == Reduction::gain ? *s.greatest - *s.first - given : *s.first - *s.least;
      return amount > rounding ? (amount - rounding) / work : 0.0;
    }
  }
  return std::nullopt;
}

std::vector<Verdict> Expectations::verdicts() const {
  std::vector<Verdict> out;
  for (const Watched& w : watched_) {
    Verdict verdict{w.expected, std::nullopt, false, std::nullopt};
    std::vector<double> tracks;
    for (size_t i = 0; i < w.seen.size(); ++i) {
      if (const auto v = reduced(w.seen[i], w.quantity.tracks()[i].reduction, w.expected.given))
        tracks.push_back(*v);
    }
    if (tracks.size() == w.seen.size()) {
      verdict.measured = w.quantity.combine(tracks, w.t);
      if (w.quantity.only() == Reduction::drift) verdict.drift_scale = w.seen[0].scale;
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
