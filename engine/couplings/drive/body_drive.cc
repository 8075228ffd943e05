// A body moved by a path and a turn through its BodyPort: at the start of a substep it is placed at their
// pose, with the velocities (x1 - x0) / h and rotation_vector(q1 q0*) / h, and at the end at their pose then.
// A free body is led in between: what it strikes is moved by the path, not by the body's own mass, and what
// lies on it feels the path's acceleration throughout the substep, not as a jump of velocity at its start.
#include <algorithm>
#include <cmath>

#include "engine/animation/driver.h"
#include "engine/core/ports/body_carrier.h"
#include "engine/core/ports/body_sleep.h"
#include "engine/couplings/drive/drive.h"
#include "engine/geometry/shape.h"
#include "engine/kernels/animation/joint_tree.h"

namespace truestep::drive {

using animation::conjugate;
using animation::Driver;
using animation::operator*;
using animation::rotate;

namespace {

/// Pose of the channels' frame.
struct Guide {
  const Driver& driver;
  std::optional<Driver::Channel> path, turn;

  Pose at(double t) const {
    Pose out;
    double x[4];
    if (path) driver.sample(*path, t, x), out.position = load3(x, 0);
    if (turn) driver.sample(*turn, t, x), out.orientation = {x[0], x[1], x[2], x[3]};
    return out;
  }
};

class BodyDrive final : public Coupling {
 public:
  BodyDrive(const Guide& guide, const BodyPort& port, uint64_t body, const Pose& offset, std::string what)
      : guide_(guide), port_(port), body_(body), offset_(offset), what_(std::move(what)) {}

  State initial_state() const override { return {}; }
  void begin(const CoupledStates& s, const StepInput& in) const override {
    const auto row = put(s, in, in.t);
    const BodySleep* sleep = port_.owner ? port_.owner->sleep() : nullptr;
    if (!row || !sleep) return;
    const Way rate = rates(in.t, in.h);
    sleep->lead(s.b, *row, rate.move, rate.turn);
  }
  // Wakes the body, which ends the lead.
  void end(const CoupledStates& s, const StepInput& in) const override { put(s, in, in.t + in.h); }
  void observe(const ConstCoupledStates& s, Observables& out) const override {
    const ConstBodies bodies(s.b, port_);
    const auto row = bodies.row_of(body_);
    const Vec3 x = row ? bodies.place(*row) : Vec3{};
    out.add("x", x.x, "m");
    out.add("y", x.y, "m");
    out.add("z", x.z, "m");
  }
  std::vector<PlanRow> plan() const override { return {{PlanRow::Status::runs, "drive", what_}}; }

 private:
  /// m/s and rad/s on the way from one pose to another, or m/s^2 and rad/s^2.
  struct Way {
    Vec3 move, turn;
  };
  static Way between(const Pose& from, const Pose& to, double h) {
    const Quat on = animation::nearer({}, normalized(to.orientation * conjugate(from.orientation)));
    return {(to.position - from.position) / h, free_rotation::rotation_vector(on) / h};
  }
  Pose pose(double t) const { return guide_.at(t) * offset_; }
  /// Accelerations in the substep from t to t + h, by the velocities in it, before and after it: the smaller
  /// of the two changes. A jump of velocity is none: it is met where it is.
  Way rates(double t, double h) const {
    const Pose now = pose(t), then = pose(t + h);
    const Way here = between(now, then, h), next = between(then, pose(t + 2 * h), h);
    // Nothing is known of what was before the start: by the two halves of the substep then.
    const Pose middle = pose(t + 0.5 * h);
    const bool starts = !(t > 0);
    const Way last = starts ? between(now, middle, 0.5 * h) : between(pose(t - h), now, h),
              from = starts ? between(middle, then, 0.5 * h) : here;
    const double span = starts ? 0.5 * h : h;
    return {smaller((from.move - last.move) / span, (next.move - here.move) / h),
            smaller((from.turn - last.turn) / span, (next.turn - here.turn) / h)};
  }
  /// Half of a + b, no longer than the shorter of them; zero where they point apart.
  static Vec3 smaller(const Vec3& a, const Vec3& b) {
    const Vec3 mean = (a + b) * 0.5;
    const double most = std::sqrt(std::min(norm2(a), norm2(b))), length = norm(mean);
    if (!(dot(a, b) > 0)) return {};
    return length > most ? mean * (most / length) : mean;
  }
  /// Places the body at its pose at t, with the velocities that take it through the next substep; its row.
  std::optional<size_t> put(const CoupledStates& s, const StepInput& in, double t) const {
    const ConstBodies bodies(s.b, port_);
    const auto row = bodies.row_of(body_);
    if (!row) return row;
    const Pose now = pose(t);
    const Way way = between(now, pose(t + in.h), in.h);
    auto& wanted = in.workspace.object<CarriedBodies>("drive.wanted");
    wanted.start(bodies.count());
    wanted.want(*row, {now.position, normalized(now.orientation), way.move, way.turn});
    carry(s.b, port_, wanted, in.workspace);
    return row;
  }

  Guide guide_;
  BodyPort port_;
  uint64_t body_;
  Pose offset_;  ///< of the body in the guide's frame
  std::string what_;
};

}  // namespace

std::unique_ptr<const Coupling> build_body_drive(const DriveDef& d, const CouplingContext& context) {
  const Driver& driver = *context.a.system.ports().driver;
  Guide guide{driver, {}, {}};
  const auto find = [&](const std::string& name, const char* member, Driver::Channel::Kind kind) {
    const auto channel = driver.channel(kind, name);
    if (!channel && !name.empty()) {
      refuse_drive(member, std::string("there is no ") + member + " \"" + name + '"', name,
                   driver.channel_names(kind));
    }
    return channel;
  };
  guide.path = find(d.path, "path", Driver::Channel::Kind::path);
  guide.turn = find(d.turn, "turn", Driver::Channel::Kind::turn);
  const Ports b = context.b.system.ports();
  if (!b.bodies) {
    refuse_drive("b", '"' + context.b.id + "\" has no bodies", '"' + context.b.id + '"',
                 "a rigid3d or an articulation");
  }
  const ConstBodies bodies(context.b.state, *b.bodies);
  const auto row = static_cast<size_t>(*d.body);
  if (row >= bodies.count()) {
    refuse_drive("body", "there is no such body", std::to_string(row),
                 bodies.count() == 0 ? "there are none" : "0 to " + std::to_string(bodies.count() - 1));
  }
  if (!can_be_carried(*b.bodies)) {
    refuse_drive("b", "bodies of \"" + context.b.id + "\" cannot be moved by paths", '"' + context.b.id + '"',
                 "a rigid3d or an articulation");
  }
  if (!bodies.dynamic(row)) {
    // Kinematic bodies accept a velocity, fixed ones do not.
    Command probe;
    probe.kind = CommandKind::set_parameter, probe.system = context.b.id, probe.name = "velocity";
    probe.index = *d.body;
    State there = context.b.state;
    try {
      context.b.system.apply(there, probe);
    } catch (const Error& e) {
      refuse_drive("body", e.what(), std::to_string(row), "a dynamic or kinematic body");
    }
  }
  const Pose start = guide.at(0);
  const Quat back = conjugate(start.orientation);
  const Pose offset{rotate(back, bodies.place(row) - start.position),
                    normalized(back * bodies.orientation(row))};
  std::string what = "body " + std::to_string(row) + " of " + context.b.id + " along";
  if (guide.path) what += " " + d.path;
  if (guide.turn) what += " " + d.turn;
  return std::make_unique<BodyDrive>(guide, *b.bodies, bodies.id_of(row), offset, what);
}

}  // namespace truestep::drive
