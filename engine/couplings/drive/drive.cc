#include "engine/couplings/drive/drive.h"

#include "engine/base/errors.h"

namespace truestep::drive {

const DefTable& drive_table() {
  using D = DriveDef;
  static const DefTable t = TableOf<D>("a control of a sets a parameter of b")
                                .text("control", &D::control, "name of a control of a")
                                .required()
                                .text("parameter", &D::parameter, "a parameter of b that set_parameter knows")
                                .required()
                                .build();
  return t;
}

Cost drive_cost(const void*, const Cost&, const Cost&) {
  return {.state_bytes = 8, .workspace_bytes = 512, .elements = 1, .seconds_per_step = 1e-7};
}

namespace {

class Drive final : public Coupling {
 public:
  Drive(const DriveDef& def, const CouplingContext& context, FieldPlace values, size_t row)
      : a_(context.a.system), b_(context.b.system), values_(values), row_(row), control_(def.control) {
    command_.kind = CommandKind::set_parameter;
    command_.system = context.b.id, command_.name = def.parameter;
  }

  State initial_state() const override {
    State s;
    s.add({"value", "1"}, 1);
    return s;
  }
  void begin(const CoupledStates& s, const StepInput& in) const override {
    struct Scratch {
      Command command;
      std::vector<double> values;
    };
    auto& scratch = in.workspace.object<Scratch>("drive");
    if (scratch.command.name != command_.name) scratch.command = command_;
    const FieldView view = a_.field(s.a, values_.part, values_.field, scratch.values);
    scratch.command.value = static_cast<const double*>(view.data)[row_];
    s.own.f64(0)[0] = scratch.command.value;
    try {
      b_.apply(s.b, scratch.command);
    } catch (const Error& e) {
      throw Instability(command_.system, command_.name, -1,
                        "what drives " + command_.name + " left what it may be: " + e.what());
    }
  }
  void end(const CoupledStates&, const StepInput&) const override {}
  void observe(const ConstCoupledStates& s, Observables& out) const override {
    out.add("value", s.own.f64(0)[0], "1");
  }
  std::vector<PlanRow> plan() const override {
    return {{PlanRow::Status::runs, "drive", command_.name + " of " + command_.system + " is " + control_}};
  }

 private:
  const System &a_, &b_;
  FieldPlace values_;
  size_t row_;
  std::string control_;
  Command command_;
};

[[noreturn]] void refuse(const std::string& member, const std::string& why, const std::string& value,
                         const std::string& allowed) {
  throw Error("scene_invalid", why, {{"/" + member, "unsuitable_system", why, value, allowed, "", ""}});
}

}  // namespace

std::unique_ptr<const Coupling> build_drive(const void* def, const CouplingContext& context) {
  const auto& d = *static_cast<const DriveDef*>(def);
  const System& a = context.a.system;
  std::optional<FieldPlace> place;
  for (size_t p = 0; p < a.parts().size(); ++p) {
    if (a.parts()[p].name == "controls") place = FieldPlace{p, 0};
  }
  if (!place) {
    refuse("a", '"' + context.a.id + "\" has no controls", '"' + context.a.id + '"',
           "a system of animation with controls");
  }
  // The part's rows are the controls, in the order of their observables.
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
  if (found == SIZE_MAX) refuse("control", "there is no control \"" + d.control + "\"", d.control, all);
  auto drive = std::make_unique<Drive>(d, context, *place, found);
  State b = context.b.state;
  Command first;
  first.kind = CommandKind::set_parameter, first.system = context.b.id, first.name = d.parameter;
  std::vector<double> scratch;
  first.value = static_cast<const double*>(a.field(context.a.state, place->part, 0, scratch).data)[found];
  try {
    context.b.system.apply(b, first);
  } catch (const Error& e) {
    refuse("parameter", e.what(), d.parameter, e.issues().empty() ? "" : e.issues()[0].allowed);
  }
  return drive;
}

}  // namespace truestep::drive
