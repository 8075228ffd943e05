// Controls, paths, vectors and turns of a scene, compiled: their values at a time, and all expressions of
// them as one program. A control set by a command keeps that value; the column of such values is the only
// state.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/animation/driver_def.h"
#include "engine/base/errors.h"
#include "engine/core/commands/command.h"
#include "engine/core/state/state.h"
#include "engine/kernels/animation/arc_length.h"
#include "engine/math/expression/names.h"
#include "engine/math/expression/program.h"

namespace truestep::animation {

class Driver {
 public:
  /// For the system with this id. Faults are collected; see finish.
  Driver(const DriverDef& def, std::string system);

  /// The number of an output for the text at this JSON pointer; before finish.
  size_t add(const std::string& pointer, const std::string& text);
  /// Three consecutive outputs; missing texts mean 0, more than three are a fault.
  size_t add_vector(const std::string& pointer, const std::vector<std::string>& texts);
  /// The turn with this name; a fault at the pointer when there is none.
  size_t turn(const std::string& pointer, const std::string& name);
  void fault(Issue issue) { issues_.push_back(std::move(issue)); }
  /// Compiles. Throws Error "scene_invalid" with all faults collected so far and every text that is not
  /// finite at t = 0.
  void finish();

  size_t controls() const { return names_of_.size(); }
  const std::string& control(size_t k) const { return names_of_[k]; }
  /// Adds the column of set values, NaN where nothing was set.
  static constexpr std::string_view kColumn = "control";
  void add_column(State& state) const;

  struct Scratch {
    std::vector<double> registers, variables, outputs;
    std::vector<std::vector<double>> own;  ///< registers of the controls' own programs
    bool ready = false;
  };
  /// Outputs at time t (s); `set`: the column of set values. Throws Instability where one is not finite.
  std::span<const double> evaluate(double t, std::span<const double> set, Scratch& scratch) const;
  /// The same without the check.
  std::span<const double> outputs_at(double t, std::span<const double> set, Scratch& scratch) const;
  /// The turn at time t, or at the frame that t falls in when there is a frame rate.
  Quat turn_at(size_t turn, double t) const { return turns_[turn].sample(frame_time(t, frame_rate_)); }

  /// What couplings access by name: a path (3 numbers), a vector, a turn (w, x, y, z).
  struct Channel {
    enum class Kind : uint8_t { path, vector, turn } kind = Kind::path;
    size_t index = 0, width = 3;
  };
  std::optional<Channel> channel(Channel::Kind kind, std::string_view name) const;
  /// Names of all of a kind, for messages.
  std::string channel_names(Channel::Kind kind) const;
  /// `width` numbers at time t (s), or at the frame that t falls in when there is a frame rate.
  void sample(const Channel& channel, double t, std::span<double> out) const;

  /// set_parameter of a control: true when `name` is one. Its caller refuses values of another kind.
  bool apply(State& state, State::Column column, const Command& command) const;
  /// Values of all controls at time t (s).
  std::vector<double> control_values(double t, std::span<const double> set) const;
  const std::vector<std::string>& control_names() const { return names_of_; }
  size_t memory_bytes() const;

 private:
  using Node = ExpressionGraph::Node;
  struct Control {
    std::optional<KeyCurve> keys;
    ExpressionProgram program;  ///< used when there are no keys
  };
  struct Path {
    KeyCurve curve;
    std::optional<ArcLength> length;
    Extend extend = Extend::clamp;
    Vec3 at(double t) const;
  };
  void add_name(const std::string& pointer, const std::string& name, int32_t variable);
  Node read(const std::string& pointer, const std::string& text);
  void values_at(double t, std::span<const double> set, Scratch& scratch) const;

  std::string system_;
  double frame_rate_ = 0;
  ExpressionGraph graph_;
  ExpressionNames names_;
  std::vector<Issue> issues_;
  std::vector<std::string> names_of_;
  std::vector<Control> controls_;
  std::vector<std::string> path_names_, vector_names_;
  std::vector<Path> paths_;
  std::vector<KeyCurve> vectors_;
  std::vector<std::string> turn_names_;
  std::vector<RotationCurve> turns_;
  std::vector<Node> roots_;
  std::vector<std::string> pointers_;  ///< of the roots' texts
  size_t variables_ = 0;               // t, controls, paths x 3, vectors one behind the other
  ExpressionProgram program_;
};

}  // namespace truestep::animation
