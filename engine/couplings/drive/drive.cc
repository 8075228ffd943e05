#include "engine/couplings/drive/drive.h"

#include "engine/animation/driver.h"
#include "engine/base/errors.h"

namespace truestep::drive {

using animation::Driver;

const DefTable& drive_table() {
  using D = DriveDef;
  static const DefTable t =
      TableOf<D>("channels of a, an animation, set parameters of b or move one of its bodies")
          .text("control", &D::control, "name of a control of a: sets a number")
          .text("path", &D::path, "name of a path of a: sets a vector, or moves a body")
          .text("vector", &D::vector,
                "name of a vector of a: sets parameters in their order, one number each, three for a vector "
                "parameter")
          .text("turn", &D::turn, "name of a turn of a: rotates a body")
          .text("parameter", &D::parameter, "a parameter of b that set_parameter can change")
          .texts("parameters", &D::parameters, {0, 1000}, "several such parameters, for a vector")
          .integer("index", &D::index, at_least(0), "row that the parameters belong to, if they have one")
          .integer("body", &D::body, at_least(0),
                   "body of b that path and turn move, from its position at t = 0")
          .check([](const D& d, const DefTable::Report& report) {
            const bool pose = d.body.has_value();
            const int given = !d.control.empty() + !d.path.empty() + !d.vector.empty();
            if (pose) {
              if (d.path.empty() && d.turn.empty()) report("/body", "needs a path, a turn or both");
              if (!d.control.empty() || !d.vector.empty()) {
                report(d.control.empty() ? "/vector" : "/control", "path and turn together need a body");
              }
              if (!d.parameter.empty() || !d.parameters.empty()) {
                report(d.parameter.empty() ? "/parameters" : "/parameter",
                       "give either a body or parameters");
              }
              return;
            }
            if (!d.turn.empty()) report("/turn", "a turn needs a body");
            if (given != 1) report("", "needs exactly one of control, path and vector");
            if (d.parameter.empty() == d.parameters.empty())
              report(d.parameter.empty() ? "/parameter" : "/parameters", "needs parameter or parameters");
            if (!d.parameters.empty() && d.vector.empty())
              report("/parameters", "several parameters need a vector");
          })
          .build();
  return t;
}

Cost drive_cost(const void* def, const Cost&, const Cost&) {
  const auto& d = *static_cast<const DriveDef*>(def);
  const double n = 1 + static_cast<double>(d.parameters.size());
  return {.state_bytes = 8 * n,
          .workspace_bytes = 512 + 200 * n,
          .elements = 1,
          .seconds_per_step = (d.body ? 1e-6 : 1e-7) * n};
}

void refuse_drive(const std::string& member, const std::string& why, const std::string& value,
                  const std::string& allowed) {
  throw Error("scene_invalid", why, {"/" + member, "unsuitable_system", why, value, allowed, "", ""});
}

namespace {

/// Source of the driving numbers: a control as held in the state, or a channel sampled at a time.
class Source {
 public:
  Source(const System& a, FieldPlace values, size_t row) : a_(a), values_(values), row_(row) {}
  Source(const System& a, const Driver& driver, const Driver::Channel& channel)
      : a_(a), driver_(&driver), channel_(channel) {}

  size_t width() const { return driver_ ? channel_.width : 1; }
  void read(const State& a, double t, std::vector<double>& scratch, std::span<double> out) const {
    if (driver_) return driver_->sample(channel_, t, out);
    out[0] = static_cast<const double*>(a_.field(a, values_.part, values_.field, scratch).data)[row_];
  }

 private:
  const System& a_;
  FieldPlace values_;
  size_t row_ = 0;
  const Driver* driver_ = nullptr;
  Driver::Channel channel_;
};

struct Target {
  Command command;
  size_t width = 1;  ///< 3: a vector
  void take(std::span<const double> numbers) {
    if (width == 3) {
      command.vector = load3(numbers.data(), 0);
    } else {
      command.value = numbers[0];
    }
  }
};

class Drive final : public Coupling {
 public:
  Drive(const System& b, Source source, std::vector<Target> targets, std::string what)
      : b_(b), source_(source), targets_(std::move(targets)), what_(std::move(what)) {}

  State initial_state() const override {
    State s;
    s.add({"value", "1"}, source_.width());
    return s;
  }
  void begin(const CoupledStates& s, const StepInput& in) const override {
    struct Scratch {
      std::vector<Target> targets;
      std::vector<double> values;
    };
    auto& scratch = in.workspace.object<Scratch>("drive");
    if (scratch.targets.empty()) scratch.targets = targets_;
    const std::span<double> now = s.own.f64(0);
    source_.read(s.a, in.t, scratch.values, now);
    size_t next = 0;
    for (Target& t : scratch.targets) {
      t.take(std::span<const double>(now).subspan(next, t.width)), next += t.width;
      try {
        b_.apply(s.b, t.command);
      } catch (const Error& e) {
        throw Instability(t.command.system, t.command.name, -1,
                          "what drives " + t.command.name + " left the allowed range: " + e.what());
      }
    }
  }
  void end(const CoupledStates&, const StepInput&) const override {}
  void observe(const ConstCoupledStates& s, Observables& out) const override {
    const auto now = s.own.f64(0);
    if (now.size() == 1) return out.add("value", now[0], "1");
    for (size_t k = 0; k < now.size(); ++k) out.add("value." + std::to_string(k), now[k], "1");
  }
  std::vector<PlanRow> plan() const override {
    std::string names;
    for (const Target& t : targets_) names += (names.empty() ? "" : ", ") + t.command.name;
    return {{PlanRow::Status::runs, "drive",
             names + " of " + targets_[0].command.system + (targets_.size() > 1 ? " are " : " is ") + what_}};
  }

 private:
  const System& b_;
  Source source_;
  std::vector<Target> targets_;
  std::string what_;
};

Source control_of(const DriveDef& d, const CouplingContext& context) {
  const System& a = context.a.system;
  std::optional<FieldPlace> place;
  for (size_t p = 0; p < a.parts().size(); ++p) {
    if (a.parts()[p].name == "controls") place = FieldPlace{p, 0};
  }
  if (!place) {
    refuse_drive("a", '"' + context.a.id + "\" has no controls", '"' + context.a.id + '"',
                 "a system of animation with controls");
  }
  // The rows of the part are the controls, in the order of their observables.
  Observables seen;
  a.observe(context.a.state, 0, seen);
  std::string all;
  size_t row = 0, found = SIZE_MAX;
  for (const Observation& o : seen.rows()) {
    constexpr std::string_view kPrefix = "control.";
    if (!o.name.starts_with(kPrefix)) continue;
    const std::string name = o.name.substr(kPrefix.size());
    if (name == d.control) found = row;
    all += (row++ > 0 ? ", " : "") + name;
  }
  if (found == SIZE_MAX) refuse_drive("control", "there is no control \"" + d.control + "\"", d.control, all);
  return {a, *place, found};
}

Source channel_of(const DriveDef& d, const System& a) {
  const Driver& driver = *a.ports().driver;
  const bool path = d.vector.empty();
  const auto kind = path ? Driver::Channel::Kind::path : Driver::Channel::Kind::vector;
  const std::string& name = path ? d.path : d.vector;
  const auto channel = driver.channel(kind, name);
  if (channel) return {a, driver, *channel};
  const char* member = path ? "path" : "vector";
  refuse_drive(member, std::string("there is no ") + member + " \"" + name + '"', name,
               driver.channel_names(kind));
}

/// Whether set_parameter uses the vector: two different ones then lead to different states.
bool takes_vector(const System& b, const State& state, Command c) {
  State one = state, other = state;
  b.apply(one, c);
  c.vector.x += 1;
  b.apply(other, c);
  return one.hash() != other.hash();
}

}  // namespace

std::unique_ptr<const Coupling> build_drive(const void* def, const CouplingContext& context) {
  const auto& d = *static_cast<const DriveDef*>(def);
  if (d.control.empty() && !context.a.system.ports().driver) {
    refuse_drive("a", '"' + context.a.id + "\" has no channels", '"' + context.a.id + '"',
                 "keyframes, a skeleton or blend_shapes");
  }
  if (d.body) return build_body_drive(d, context);
  const Source source = d.control.empty() ? channel_of(d, context.a.system) : control_of(d, context);
  std::vector<double> scratch, now(source.width());
  source.read(context.a.state, 0, scratch, now);
  const bool list = d.parameter.empty();
  const std::vector<std::string> names = list ? d.parameters : std::vector{d.parameter};
  std::vector<Target> targets;
  State b = context.b.state;
  size_t next = 0;
  for (size_t k = 0; k < names.size(); ++k) {
    const std::string member = list ? "parameters/" + std::to_string(k) : "parameter";
    const auto left = std::span<const double>(now).subspan(std::min(next, now.size()));
    Target t;
    t.command.kind = CommandKind::set_parameter, t.command.system = context.b.id;
    t.command.name = names[k], t.command.index = d.index.value_or(-1);
    t.command.value = left.empty() ? 0 : left[0];
    try {
      t.width = takes_vector(context.b.system, b, t.command) ? 3 : 1;
      if (left.size() >= t.width) {
        t.take(left);
        context.b.system.apply(b, t.command);
      }
    } catch (const Error& e) {
      refuse_drive(member, e.what(), names[k], e.issues().empty() ? "" : e.issues()[0].allowed);
    }
    if (left.size() < t.width && t.width == 3 && source.width() == 1) {
      refuse_drive(member, names[k] + " is a vector, a control one number", names[k], "a path or a vector");
    }
    next += t.width;
    targets.push_back(std::move(t));
  }
  if (next != now.size()) {
    refuse_drive(
        list ? "parameters" : "parameter",
        "the parameters take " + std::to_string(next) + " numbers, a key has " + std::to_string(now.size()),
        std::to_string(next), std::to_string(now.size()) + " numbers");
  }
  const std::string& what = !d.control.empty() ? d.control : d.path.empty() ? d.vector : d.path;
  return std::make_unique<Drive>(context.b.system, source, std::move(targets), what);
}

}  // namespace truestep::drive
