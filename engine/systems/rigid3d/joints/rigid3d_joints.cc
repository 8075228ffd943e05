// Joints of the system "rigid3d" as users see them: their energy and loads, and commands to their motors.
#include <algorithm>
#include <cmath>

#include "engine/core/commands/command_checks.h"
#include "engine/systems/rigid3d/rigid3d.h"

namespace truestep::rigid3d {

JointPlace Rigid3d::place_of(const State& s, size_t joint) const {
  const double *x = s.f64(columns::position).data(), *q = s.f64(columns::orientation).data();
  const auto held = s.span<uint32_t>(columns::joint_bodies).subspan(2 * joint, 2);
  const auto pose = [&](uint32_t i) { return i == kNoBody ? Pose{} : Pose{load3(x, i), load_quat(q, i)}; };
  return joint_place(joints_.joints[joint], pose(held[0]), pose(held[1]));
}

double Rigid3d::spring_energy(const State& s) const {
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  double sum = 0;
  for (size_t d = 0; d < joints_.drives.size(); ++d) {
    const Drive& drive = joints_.drives[d];
    if (!(drive.laws & Drive::kSpring) || broken[drive.joint]) continue;
    const double now = place_of(s, drive.joint).coordinate[drive.row];
    const double off =
        (drive.row < 3 ? now : unwrapped(now, s.f64(columns::drive_coordinate)[d])) - drive.rest;
    sum += 0.5 * drive.stiffness * off * off;
  }
  return sum;
}

double Rigid3d::widest_gap(const State& s) const {
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  double gap = 0;
  for (size_t k = 0; k < joints_.joints.size(); ++k) {
    const Joint& j = joints_.joints[k];
    if (broken[k] || j.form == Joint::Form::gear) continue;
    const JointPlace at = place_of(s, k);
    double off = 0;
    for (size_t e = 0; e < 3; ++e) off += j.locked[e] * at.coordinate[e] * at.coordinate[e];
    gap = std::max(gap, std::sqrt(off));
  }
  return gap;
}

bool Rigid3d::joints_drive(const State& s) const {
  const auto works = [](const Drive& d) { return (d.laws & Drive::kMotor) != 0; };
  double size = 0;
  for (const BodyKind& b : bodies_.kinds) {
    if (b.moved_by_forces()) size = std::max(size, b.reach);
  }
  return std::any_of(joints_.drives.begin(), joints_.drives.end(), works) || widest_gap(s) > 0.01 * size;
}

void Rigid3d::joint_loads(const State& s, JointLoad what, ShownRows rows, double* out) const {
  std::fill_n(out, 3 * rows.count, 0.0);
  const auto held = s.span<uint32_t>(columns::joint_bodies);
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  const double* load = s.f64(columns::joint_load).data();
  for (size_t k = 0; k < joints_.joints.size(); ++k) {
    if (broken[k] || joints_.joints[k].form == Joint::Form::gear) continue;
    const Vec3 made = load3(load, 2 * k + (what == JointLoad::force ? 0 : 1));
    const uint32_t a = held[2 * k], b = held[2 * k + 1];
    if (a != kNoBody) store3(out, a, load3(out, a) - made);
    if (b != kNoBody) store3(out, b, load3(out, b) + made);
  }
}

namespace {

constexpr std::string_view kFreedoms[6] = {"x.", "y.", "z.", "turn_x.", "turn_y.", "turn_z."};

// Whether "turn." of "turn.motor_speed" means the drive along this row; nothing means every drive.
bool names_drive(std::string_view freedom, uint32_t row) {
  return freedom.empty() || freedom == kFreedoms[row] || freedom == (row < 3 ? "slide." : "turn.");
}

}  // namespace

void Rigid3d::set_motor(State& s, const Command& c, std::string_view parameter) const {
  const size_t k = checked_command_row(c, joints_.joints.size(), "joint");
  const Joint& j = joints_.joints[k];
  const bool bound = parameter == "max_force" || parameter == "max_torque";
  const bool strength = bound || parameter == "max_motor";
  const std::string_view freedom = std::string_view(c.name).substr(0, c.name.size() - parameter.size());
  if (strength && c.value < 0)
    refuse_command("value", "out_of_range", "the maximum of the motor must be at least 0");
  const auto wants = parameter == "motor_speed" ? Drive::Wants::speed : Drive::Wants::place;
  const bool pose = j.form == Joint::Form::pose;
  std::vector<uint32_t> chosen;
  for (uint32_t d = j.first_drive; d < j.first_drive + j.drives; ++d) {
    const Drive& drive = joints_.drives[d];
    if (!(drive.laws & Drive::kMotor) || (!strength && drive.wants != wants)) continue;
    const bool turns = drive.row > 2;
    // A pose has one limit for its slides and one for its turns; what names no freedom moves it.
    if (pose ? parameter == "max_motor" : bound) continue;
    if (bound && (!freedom.empty() || turns != (parameter == "max_torque"))) continue;
    if (pose && !bound && freedom.empty() && turns) continue;
    if (bound || names_drive(freedom, drive.row)) chosen.push_back(d);
  }
  if (chosen.empty()) {
    refuse_command("index", "no_motor", "joint " + std::to_string(k) + " has no motor that takes " + c.name,
                   bound ? "a joint of type motor"
                         : "a joint with motor_speed or motor_target in the scene, or of type motor");
  }
  if (chosen.size() > 1 && !pose) {
    refuse_command("name", "ambiguous",
                   "joint " + std::to_string(k) + " has several motors that take " + c.name,
                   "slide., turn., x., y., z., turn_x., turn_y. or turn_z. before " + std::string(parameter));
  }
  const bool vector = pose && !bound;
  check_command_form(c, vector);
  for (const uint32_t d : chosen) {
    const double axes[3] = {c.vector.x, c.vector.y, c.vector.z};
    s.f64(columns::drive_motor)[2 * static_cast<size_t>(d) + (strength ? 1 : 0)] =
        vector ? axes[joints_.drives[d].row % 3] : c.value;
  }
  for (const uint32_t body :
       {s.span<uint32_t>(columns::joint_bodies)[2 * k], s.span<uint32_t>(columns::joint_bodies)[2 * k + 1]}) {
    if (body != kNoBody && bodies_.kinds[s.span<uint32_t>(columns::kind)[body]].moved_by_forces()) {
      wake_body(s, body, bodies_.kinds);
    }
  }
}

}  // namespace truestep::rigid3d
