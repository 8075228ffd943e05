// The outside of a system stepped by another engine: state, observables, fields, commands and drawing are
// those of our own system for the same scene.
#pragma once
#include "engine/core/commands/command_checks.h"
#include "engine/core/system.h"

namespace truestep::reference {

template <class Own>
class OwnFace : public StagedSystem {
 public:
  State initial_state() const override { return own_.initial_state(); }
  void observe(const State& s, double t, Observables& out) const override { own_.observe(s, t, out); }
  FieldView field(const State& s, size_t part, size_t field, std::vector<double>& scratch) const override {
    return own_.field(s, part, field, scratch);
  }
  void check(StateCheck& check, double t) const override { own_.check(check, t); }
  /// Motors belong to the other engine's joints.
  void apply(State& s, const Command& c) const override {
    if (c.kind == CommandKind::set_parameter && c.name.find("motor") != std::string::npos) {
      refuse_command("name", "unsupported", "motors of another engine are not set while a scene runs",
                     "the scene's motor_speed");
    }
    own_.apply(s, c);
  }
  /// Without the contacts, which belong to our own solver.
  void draw(const State& s, double t, Wish wishes, Drawing& out) const override {
    own_.draw(s, t, wishes, out);
    out.contacts.clear();
  }

 protected:
  template <class Def>
  OwnFace(const Def& def, const BuildContext& context) : own_(def, context) {
    set_parts(own_.parts());
  }

  Own own_;
};

}  // namespace truestep::reference
