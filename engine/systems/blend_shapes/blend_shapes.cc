#include "engine/systems/blend_shapes/scratch.h"

#include <algorithm>
#include <cmath>

#include "engine/animation/moved_bodies.h"
#include "engine/core/commands/command_checks.h"
#include "engine/systems/blend_shapes/shape_files.h"

namespace truestep::blend_shapes {

using namespace animation;
using namespace columns;

BlendShapes::BlendShapes(const BlendShapesDef& given, const BuildContext& context)
    : driver_(given, context.id), dt_(context.dt), order_(given.order), color_(given.color) {
  const BlendShapesDef def = with_files(given);
  build_base(def);
  for (size_t k = 0; k < def.targets.size(); ++k) add_target(def.targets[k], k);
  position_ = driver_.add_vector("/position", def.position);
  rotation_ = driver_.add_vector("/rotation", def.rotation);
  driver_.finish();
  size_t offsets = 0;
  for (const ShapeOffsets& t : targets_) offsets += t.rows.size();
  add_stage("blend",
            std::to_string(base_.size()) + " vertices, " + std::to_string(targets_.size()) +
                " targets that move " + std::to_string(offsets) + " of them",
            [this](State& s, const StepInput& in) {
              update(s, in.t + in.h, in.h, in.workspace.object<Scratch>("blend_shapes"));
            });
  show();
  set_remedies({"weights that stay finite at every time"});
}

void BlendShapes::build_base(const BlendShapesDef& def) {
  base_ = def.vertices;
  for (size_t k = 0; k + 2 < def.triangles.size(); k += 3) {
    const auto at = [&](size_t i) { return static_cast<uint32_t>(def.triangles[k + i]); };
    triangles_.push_back({at(0), at(1), at(2)});
  }
  if (def.ball) {
    const auto rings = static_cast<uint32_t>(def.ball->rings),
               around = static_cast<uint32_t>(def.ball->around);
    base_.push_back({0, def.ball->radius, 0});
    for (uint32_t r = 1; r <= rings; ++r) {
      const auto [sin, cos] = trig::sincos(3.141592653589793 * r / (rings + 1));
      for (uint32_t k = 0; k < around; ++k) {
        const auto [s, c] = trig::sincos(6.283185307179586 * k / around);
        base_.push_back(Vec3{sin * c, cos, sin * s} * def.ball->radius);
      }
    }
    base_.push_back({0, -def.ball->radius, 0});
    const auto last = static_cast<uint32_t>(base_.size() - 1);
    const auto at = [&](uint32_t ring, uint32_t k) { return 1 + (ring - 1) * around + k % around; };
    for (uint32_t k = 0; k < around; ++k) {
      triangles_.push_back({0, at(1, k + 1), at(1, k)});
      for (uint32_t r = 1; r < rings; ++r) {
        triangles_.push_back({at(r, k), at(r, k + 1), at(r + 1, k)});
        triangles_.push_back({at(r, k + 1), at(r + 1, k + 1), at(r + 1, k)});
      }
      triangles_.push_back({at(rings, k), at(rings, k + 1), last});
    }
  }
  if (def.base.empty()) return;
  std::vector<std::string> texts = def.base;
  const char* const same[] = {"x", "y", "z"};
  for (size_t k = texts.size(); k < 3; ++k) texts.emplace_back(same[k]);
  base_ = sampled("/base", texts);
}

std::vector<Vec3> BlendShapes::sampled(const std::string& pointer, const std::vector<std::string>& texts) {
  ExpressionGraph graph;
  ExpressionNames names;
  names.add_value("x", graph.variable(0));
  names.add_value("y", graph.variable(1));
  names.add_value("z", graph.variable(2));
  names.add_value("pi", graph.constant(3.141592653589793));
  std::vector<ExpressionGraph::Node> roots;
  for (size_t k = 0; k < 3; ++k) {
    try {
      roots.push_back(k < texts.size() ? names.require(graph, texts[k]) : graph.constant(0));
    } catch (const ExpressionFault& f) {
      driver_.fault({pointer + "/" + std::to_string(k), "bad_expression", describe(f, texts[k]), texts[k], "",
                     f.did_you_mean, ""});
      roots.push_back(graph.constant(0));
    }
  }
  const ExpressionProgram program(graph, roots, 3);
  std::vector<double> registers(program.registers());
  program.start(registers.data());
  std::vector<Vec3> out;
  for (const Vec3& b : base_) {
    registers[0] = b.x, registers[1] = b.y, registers[2] = b.z;
    double values[3];
    program.run(registers.data(), values);
    out.push_back({values[0], values[1], values[2]});
    if (std::isfinite(norm2(out.back()))) continue;
    driver_.fault({pointer, "not_finite", "not finite at a vertex of the base", "", "", "", ""});
    out.assign(base_.size(), {});
    break;
  }
  return out;
}

void BlendShapes::add_target(const TargetDef& d, size_t number) {
  const std::string at = "/targets/" + std::to_string(number);
  if (std::ranges::find(names_, d.name) != names_.end()) {
    driver_.fault({at + "/name", "duplicate_name", "another target has this name", d.name, "", "", ""});
  }
  std::vector<Vec3> offsets;
  if (d.vertices.empty()) {
    offsets = sampled(at + "/offset", d.offset);
  } else {
    for (size_t i = 0; i < base_.size(); ++i) offsets.push_back(d.vertices[i] - base_[i]);
  }
  ShapeOffsets shape;
  for (size_t i = 0; i < base_.size(); ++i) {
    if (norm2(offsets[i]) == 0) continue;
    shape.rows.push_back(static_cast<uint32_t>(i)), shape.offsets.push_back(offsets[i]);
  }
  names_.push_back(d.name);
  targets_.push_back(std::move(shape));
  weights_.push_back(driver_.add(at + "/weight", d.weight));
}

State BlendShapes::initial_state() const {
  State s;
  s.add({"position", "m", Scalar::f64, 3, Role::position}, base_.size());
  s.add({"velocity", "m/s", Scalar::f64, 3, Role::velocity}, base_.size());
  s.add({"inverse_mass", "1/kg"}, base_.size());
  driver_.add_column(s);
  Scratch scratch;
  update(s, 0, 0, scratch);
  // The velocities at the start are those of the first step.
  State ahead = s;
  update(ahead, dt_, dt_, scratch);
  s.copy_column(kVelocity, ahead, kVelocity);
  return s;
}

void BlendShapes::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  if (c.kind != CommandKind::set_parameter) {
    refuse_command("type", "unsupported_command", "a blended surface moves as prescribed", "set_parameter");
  }
  if (driver_.apply(s, kControl, c)) return;
  std::string all;
  for (size_t k = 0; k < driver_.controls(); ++k) all += (k > 0 ? ", " : "") + driver_.control(k);
  refuse_command("name", "unknown_parameter", "there is no control \"" + c.name + "\"", all);
}

void BlendShapes::draw(const State&, double, Wish wishes, Drawing& out) const {
  if (!wants(wishes, Wish::constant)) return;
  out.parts.resize(1);
  out.parts[0].triangles = triangles_;
  if (color_) out.parts[0].color = std::array{color_->x, color_->y, color_->z};
}

Ports BlendShapes::ports() const {
  Ports out;
  out.morph = this, out.driver = &driver_;
  out.points = PointPort{.position = kPosition,
                         .velocity = kVelocity,
                         .mass = std::nullopt,
                         .inverse_mass = kInverseMass,
                         .id = std::nullopt,
                         .radius = 0};
  out.solids = {triangles_, {}};
  return out;
}

Morphed::Port BlendShapes::morph() const {
  return {base_, triangles_, names_, targets_};
}

Pose BlendShapes::morph_at(const State& s, double t, std::span<double> weights) const {
  Driver::Scratch scratch;
  const auto out = driver_.outputs_at(t, s.f64(kControl), scratch);
  for (size_t k = 0; k < targets_.size(); ++k) weights[k] = out[weights_[k]];
  return {load3(&out[position_], 0), euler_rotation(order_, load3(&out[rotation_], 0))};
}

std::unique_ptr<const System> build_blend_shapes(const void* def, const BuildContext& context) {
  return std::make_unique<BlendShapes>(*static_cast<const BlendShapesDef*>(def), context);
}

}  // namespace truestep::blend_shapes
