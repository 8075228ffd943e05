#include "engine/scene/settable.h"

namespace truestep {

namespace {

using P = SettableParameter;
constexpr P::Form kNumber = P::Form::number, kVector = P::Form::vector, kEither = P::Form::either;
constexpr P::Of kSystem = P::Of::system, kBody = P::Of::body, kJoint = P::Of::joint;

constexpr P kGravity{"gravity", kVector, kSystem, "m/s^2"};
constexpr P kWind{"wind", kVector, kSystem};
constexpr P kVelocity{"velocity", kVector, kBody, "m/s", "of a dynamic or kinematic body's centre of mass"};
constexpr P kMotorSpeed{"motor_speed", kEither, kJoint, "rad/s or m/s",
                        "of a motor with a speed; a vector for a joint of type motor that has a velocity; "
                        "turn.motor_speed: its angular velocity"};
constexpr P kMotorTarget{"motor_target", kEither, kJoint, "rad or m",
                         "of a motor with a target; a vector (m) for a joint of type motor or mouse; "
                         "turn.motor_target: its turn"};
constexpr P kMaxMotor{"max_motor", kNumber, kJoint, "N m or N", "largest torque or force of the motor"};
constexpr P kMaxForce{"max_force", kNumber, kJoint, "N", "of a joint of type motor or mouse"};
constexpr P kMaxTorque{"max_torque", kNumber, kJoint, "N m", "of a joint of type motor"};

constexpr P kRigid3d[] = {
    kGravity,    kVelocity,    {"angular_velocity", kVector, kBody, "rad/s", "in the world"},
    kMotorSpeed, kMotorTarget, kMaxMotor,
    kMaxForce,   kMaxTorque};
constexpr P kRigid2d[] = {kGravity,    kVelocity,    {"angular_velocity", kNumber, kBody, "rad/s"},
                          kMotorSpeed, kMotorTarget, kMaxMotor,
                          kMaxForce,   kMaxTorque};
constexpr P kArticulation[] = {
    kGravity, {"<link>.torque", kNumber, kSystem, "N m or N", "of the joint of the link with that id"}};
constexpr P kOnlyGravity[] = {kGravity};
constexpr P kMassSpring[] = {{"stiffness", kNumber, kSystem},
                             {"shear_stiffness", kNumber, kSystem},
                             {"bending_stiffness", kNumber, kSystem},
                             {"damping", kNumber, kSystem},
                             {"internal_damping", kNumber, kSystem},
                             kGravity,
                             kWind};
constexpr P kXpbd[] = {{"stiffness", kNumber, kSystem},
                       {"shear_stiffness", kNumber, kSystem},
                       {"youngs_modulus", kNumber, kSystem},
                       {"bending_rigidity", kNumber, kSystem},
                       {"flexural_rigidity", kNumber, kSystem},
                       {"bulk_modulus", kNumber, kSystem},
                       {"damping", kNumber, kSystem},
                       {"internal_damping", kNumber, kSystem},
                       kGravity,
                       kWind};
constexpr P kFem[] = {kGravity, {"youngs_modulus", kNumber, kSystem}, {"damping", kNumber, kSystem}};
constexpr P kParticles[] = {kGravity,
                            kWind,
                            {"electric_field", kVector, kSystem},
                            {"magnetic_field", kVector, kSystem},
                            {"linear_drag", kNumber, kSystem},
                            {"quadratic_drag", kNumber, kSystem},
                            {"thrust", kNumber, kSystem, "N"}};
constexpr P kNbody[] = {{"gravitational_constant", kNumber, kSystem}, {"softening", kNumber, kSystem}};
constexpr P kCrowd[] = {{"speed_factor", kNumber, kSystem}};
constexpr P kFlocking[] = {{"separation", kNumber, kSystem}, {"alignment", kNumber, kSystem},
                           {"cohesion", kNumber, kSystem},   {"goal_strength", kNumber, kSystem},
                           {"noise", kNumber, kSystem},      {"coupling", kNumber, kSystem},
                           {"goal", kVector, kSystem, "m"}};
constexpr P kMolecular[] = {{"temperature", kNumber, kSystem, "K", "of the thermostat"},
                            {"pressure", kNumber, kSystem, "Pa", "of the barostat"}};
constexpr P kWave[] = {{"speed", kNumber, kSystem, "m/s"}, {"damping", kNumber, kSystem}};
constexpr P kHeat[] = {{"diffusivity", kNumber, kSystem, "m^2/s"}};
constexpr P kGridFluid[] = {{"viscosity", kNumber, kSystem}};
constexpr P kHeightfield[] = {{"friction", kNumber, kSystem}};
constexpr P kOscillator[] = {{"stiffness", kNumber, kSystem},
                             {"damping", kNumber, kSystem},
                             {"mass", kNumber, kSystem},
                             {"drive_force", kNumber, kSystem},
                             {"drive_frequency", kNumber, kSystem}};
constexpr P kPendulum[] = {{"gravity", kNumber, kSystem, "m/s^2"}, {"damping", kNumber, kSystem}};
constexpr P kOde[] = {{"<name>", kNumber, kSystem, "", "a parameter or a state of the scene"}};
constexpr P kControls[] = {{"<control>", kNumber, kSystem, "", "a control of the scene"}};

struct OfType {
  std::string_view type;
  std::span<const P> rows;
};
constexpr OfType kTypes[] = {{"rigid3d", kRigid3d},
                             {"rigid2d", kRigid2d},
                             {"articulation", kArticulation},
                             {"rod_chain", kOnlyGravity},
                             {"mass_spring", kMassSpring},
                             {"xpbd", kXpbd},
                             {"fem", kFem},
                             {"particles", kParticles},
                             {"nbody", kNbody},
                             {"crowd", kCrowd},
                             {"flocking", kFlocking},
                             {"molecular", kMolecular},
                             {"wave", kWave},
                             {"heat", kHeat},
                             {"sph", kOnlyGravity},
                             {"mpm", kOnlyGravity},
                             {"grid_fluid", kGridFluid},
                             {"heightfield_wave", kHeightfield},
                             {"oscillator", kOscillator},
                             {"pendulum", kPendulum},
                             {"ode", kOde},
                             {"skeleton", kControls},
                             {"ik", kControls},
                             {"motion_capture", kControls},
                             {"keyframes", kControls},
                             {"blend_shapes", kControls}};

}  // namespace

std::span<const SettableParameter> settable_parameters(std::string_view system_type) {
  for (const OfType& t : kTypes) {
    if (t.type == system_type) return t.rows;
  }
  return {};
}

}  // namespace truestep
