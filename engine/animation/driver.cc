#include "engine/animation/driver.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace truestep::animation {

namespace {
std::string at(const char* list, size_t i, const char* member) {
  return std::string("/") + list + "/" + std::to_string(i) + "/" + member;
}
}  // namespace

Vec3 Driver::Path::at(double t) const {
  double x[3];
  if (length) {
    const KeyTime inside = within(t, curve.first(), curve.last(), extend);
    const double share = (inside.t - curve.first()) / (curve.last() - curve.first());
    curve.sample(length->time_at(curve, share * length->total()), x);
  } else {
    curve.sample(t, x);
  }
  return {x[0], x[1], x[2]};
}

Driver::Driver(const DriverDef& def, std::string system)
    : system_(std::move(system)), frame_rate_(def.frame_rate.value_or(0)) {
  add_name("", "t", 0);
  names_.add_value("pi", graph_.constant(3.141592653589793));
  // Paths and vectors first, so that controls may follow them.
  const auto first_path = static_cast<int32_t>(1 + def.controls.size());
  variables_ = static_cast<size_t>(first_path) + 3 * def.paths.size();
  for (size_t i = 0; i < def.paths.size(); ++i) {
    const PathDef& d = def.paths[i];
    std::vector<double> values;
    for (const Vec3& p : d.points) values.insert(values.end(), {p.x, p.y, p.z});
    const bool even = d.even_speed && d.times.size() > 1;
    // With even speed, the curve is evaluated between its ends only.
    Keys keys{.width = 3, .times = d.times, .values = values};
    keys.interpolation = d.interpolation, keys.extend = even ? Extend::clamp : d.extend;
    Path path{KeyCurve(keys), std::nullopt, d.extend};
    if (even) path.length.emplace(path.curve);
    paths_.push_back(std::move(path));
    path_names_.push_back(d.name);
    for (int32_t k = 0; k < 3; ++k) {
      const auto variable = first_path + static_cast<int32_t>(3 * i) + k;
      add_name(at("paths", i, "name"), d.name + "_" + "xyz"[k], variable);
    }
  }
  for (size_t i = 0; i < def.vectors.size(); ++i) {
    const VectorDef& d = def.vectors[i];
    Keys keys{.width = d.width(), .times = d.times, .values = d.values};
    keys.slopes_in = d.slopes_in, keys.slopes_out = d.slopes_out, keys.handles = d.handles;
    keys.interpolation = d.interpolation, keys.extend = d.extend;
    vectors_.emplace_back(keys);
    vector_names_.push_back(d.name);
    for (size_t k = 0; k < keys.width; ++k) {
      add_name(at("vectors", i, "name"), d.name + "_" + std::to_string(k),
               static_cast<int32_t>(variables_++));
    }
  }
  for (size_t i = 0; i < def.controls.size(); ++i) {
    const ControlDef& d = def.controls[i];
    Control c;
    if (d.times.empty()) {
      const Node node = read(at("controls", i, "value"), d.value);
      c.program = ExpressionProgram(graph_, std::span(&node, 1), variables_);
    } else {
      Keys keys{.width = 1, .times = d.times, .values = d.values};
      keys.slopes_in = d.slopes_in, keys.slopes_out = d.slopes_out, keys.handles = d.handles;
      keys.interpolation = d.interpolation, keys.extend = d.extend;
      c.keys.emplace(keys);
    }
    controls_.push_back(std::move(c));
    names_of_.push_back(d.name);
    add_name(at("controls", i, "name"), d.name, static_cast<int32_t>(1 + i));
  }
  for (size_t i = 0; i < def.turns.size(); ++i) {
    const TurnDef& d = def.turns[i];
    std::vector<Quat> keys;
    for (size_t k = 0; k < d.times.size(); ++k) {
      const double* q = &d.quaternions[4 * k];
      keys.push_back(normalized(Quat{q[0], q[1], q[2], q[3]}));
    }
    if (std::ranges::find(turn_names_, d.name) != turn_names_.end()) {
      fault({at("turns", i, "name"), "duplicate_name", "there is a turn of this name", d.name, "", "", ""});
    }
    turn_names_.push_back(d.name);
    turns_.emplace_back(d.times, keys, d.interpolation, d.extend);
  }
}

void Driver::add_name(const std::string& pointer, const std::string& name, int32_t variable) {
  if (names_.add_value(name, graph_.variable(variable))) return;
  fault({pointer, "bad_name", "\"" + name + "\" is taken, reserved or no name", name,
         "letters, digits and _, each name once", "", ""});
}

Driver::Node Driver::read(const std::string& pointer, const std::string& text) {
  try {
    return names_.require(graph_, text);
  } catch (const ExpressionFault& f) {
    fault({pointer, "bad_expression", describe(f, text), text, "", f.did_you_mean, ""});
    return graph_.constant(0);
  }
}

size_t Driver::add(const std::string& pointer, const std::string& text) {
  roots_.push_back(text.empty() ? graph_.constant(0) : read(pointer, text));
  pointers_.push_back(pointer);
  return roots_.size() - 1;
}

size_t Driver::add_vector(const std::string& pointer, const std::vector<std::string>& texts) {
  const size_t first = roots_.size();
  for (size_t k = 0; k < 3; ++k) {
    add(pointer + "/" + std::to_string(k), k < texts.size() ? texts[k] : "");
  }
  return first;
}

size_t Driver::turn(const std::string& pointer, const std::string& name) {
  const auto found = std::ranges::find(turn_names_, name);
  if (found != turn_names_.end()) return static_cast<size_t>(found - turn_names_.begin());
  std::string all;
  for (const std::string& n : turn_names_) all += (all.empty() ? "" : ", ") + n;
  fault({pointer, "unknown_name", "there is no turn \"" + name + "\"", name,
         all.empty() ? "no turns are given" : all, "", ""});
  return 0;
}

void Driver::finish() {
  if (!issues_.empty()) throw Error("scene_invalid", issues_[0].message, issues_);
  program_ = ExpressionProgram(graph_, roots_, variables_);
  Scratch scratch;
  const std::vector<double> none(controls_.size(), std::numeric_limits<double>::quiet_NaN());
  const auto out = outputs_at(0, none, scratch);
  for (size_t k = 0; k < out.size(); ++k) {
    if (std::isfinite(out[k])) continue;
    fault({pointers_[k], "not_finite", "it has no finite value at t = 0", "", "", "", ""});
  }
  if (!issues_.empty()) throw Error("scene_invalid", issues_[0].message, issues_);
}

void Driver::add_column(State& state) const {
  const auto c = state.add({std::string(kColumn), "1", Scalar::f64, 1, Role::sentinel}, controls_.size());
  std::ranges::fill(state.f64(c), std::numeric_limits<double>::quiet_NaN());
}

void Driver::values_at(double t, std::span<const double> set, Scratch& s) const {
  if (!s.ready) {
    s.variables.resize(variables_);
    s.registers.resize(program_.registers());
    s.outputs.resize(program_.outputs());
    s.own.resize(controls_.size());
    if (program_.registers() > 0) program_.start(s.registers.data());
    for (size_t k = 0; k < controls_.size(); ++k) {
      if (controls_[k].keys) continue;
      s.own[k].resize(controls_[k].program.registers());
      controls_[k].program.start(s.own[k].data());
    }
    s.ready = true;
  }
  std::vector<double>& v = s.variables;
  v[0] = t;
  for (size_t p = 0; p < paths_.size(); ++p) store3(&v[1 + controls_.size()], p, paths_[p].at(t));
  size_t next = 1 + controls_.size() + 3 * paths_.size();
  for (const KeyCurve& c : vectors_) c.sample(t, &v[next]), next += c.width();
  for (size_t k = 0; k < controls_.size(); ++k) {
    double& value = v[1 + k];
    if (set[k] == set[k]) {
      value = set[k];
    } else if (controls_[k].keys) {
      controls_[k].keys->sample(t, &value);
    } else {
      std::copy(v.begin(), v.end(), s.own[k].begin());
      controls_[k].program.run(s.own[k].data(), &value);
    }
  }
}

std::span<const double> Driver::evaluate(double t, std::span<const double> set, Scratch& s) const {
  const auto out = outputs_at(t, set, s);
  for (size_t k = 0; k < out.size(); ++k) {
    if (std::isfinite(out[k])) continue;
    throw Instability(system_, pointers_[k], -1, "the expression at " + pointers_[k] + " is not finite");
  }
  return out;
}

std::span<const double> Driver::outputs_at(double at, std::span<const double> set, Scratch& s) const {
  values_at(frame_time(at, frame_rate_), set, s);
  std::copy(s.variables.begin(), s.variables.end(), s.registers.begin());
  program_.run(s.registers.data(), s.outputs.data());
  return s.outputs;
}

namespace {
std::string joined(std::span<const std::string> names) {
  std::string all;
  for (const std::string& n : names) all += (all.empty() ? "" : ", ") + n;
  return all.empty() ? "none is given" : all;
}
}  // namespace

std::optional<Driver::Channel> Driver::channel(Channel::Kind kind, std::string_view name) const {
  using enum Channel::Kind;
  const auto& names = kind == path ? path_names_ : kind == vector ? vector_names_ : turn_names_;
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) return std::nullopt;
  const auto index = static_cast<size_t>(found - names.begin());
  return Channel{kind, index, kind == path ? 3 : kind == vector ? vectors_[index].width() : 4};
}

std::string Driver::channel_names(Channel::Kind kind) const {
  using enum Channel::Kind;
  return joined(kind == path ? path_names_ : kind == vector ? vector_names_ : turn_names_);
}

void Driver::sample(const Channel& c, double at, std::span<double> out) const {
  const double t = frame_time(at, frame_rate_);
  switch (c.kind) {
    case Channel::Kind::path:
      return store3(out.data(), 0, paths_[c.index].at(t));
    case Channel::Kind::vector:
      return vectors_[c.index].sample(t, out.data());
    case Channel::Kind::turn: {
      const Quat q = turns_[c.index].sample(t);
      out[0] = q.w, store3(out.data() + 1, 0, Vec3{q.x, q.y, q.z});
      return;
    }
  }
}

bool Driver::apply(State& state, State::Column column, const Command& command) const {
  const auto found = std::ranges::find(names_of_, command.name);
  if (found == names_of_.end()) return false;
  state.f64(column)[static_cast<size_t>(found - names_of_.begin())] = command.value;
  return true;
}

std::vector<double> Driver::control_values(double t, std::span<const double> set) const {
  Scratch s;
  values_at(frame_time(t, frame_rate_), set, s);
  const auto first = s.variables.begin() + 1;
  return {first, first + static_cast<ptrdiff_t>(controls())};
}

size_t Driver::memory_bytes() const {
  return program_.memory_bytes() + 200 * controls_.size();
}

}  // namespace truestep::animation
