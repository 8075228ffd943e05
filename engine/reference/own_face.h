// What a system shows when another engine steps it: state, observables, fields, commands and drawing are
// those of our own system of the same scene.
#pragma once
#include "engine/core/system.h"

namespace truestep::reference {

template <class Own>
class OwnFace : public StagedSystem {
 public:
  State initial_state() const override { return own_.initial_state(); }
  void observe(const State& s, double t, Observables& out) const override { own_.observe(s, t, out); }
  std::vector<FieldInfo> fields() const override { return own_.fields(); }
  FieldView field(const State& s, size_t which, std::vector<double>& scratch) const override {
    return own_.field(s, which, scratch);
  }
  void check(StateCheck& check, double t) const override { own_.check(check, t); }
  void apply(State& s, const Command& c) const override { own_.apply(s, c); }
  Topology topology(const State& s) const override { return own_.topology(s); }
  uint32_t topology_version(const State& s) const override { return own_.topology_version(s); }
  std::vector<DrawnShape> shapes(const State& s, double t) const override { return own_.shapes(s, t); }
  DrawnBodies bodies(const State& s) const override { return own_.bodies(s); }
  std::vector<JointMark> joint_marks(const State& s) const override { return own_.joint_marks(s); }
  size_t max_rows() const override { return own_.max_rows(); }

 protected:
  template <class Def>
  OwnFace(const Def& def, const BuildContext& context) : own_(def, context) {}

  Own own_;
};

}  // namespace truestep::reference
