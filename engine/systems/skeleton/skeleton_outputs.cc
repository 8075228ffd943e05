// What a skeleton gives out: joints, bones, skin, and how well goals, priors, markers and feet are met.
#include "engine/animation/driver_outputs.h"
#include "engine/systems/skeleton/scratch.h"

namespace truestep::skeleton {

using namespace animation;
using C = SkeletonColumns;

namespace {
constexpr MovedBodies kShownBones = MovedBodies::from(0);
constexpr size_t kMostNamed = 32;  // joints whose positions are observables
}  // namespace

struct Skeleton::GoalReach {
  double error = 0;               ///< m
  std::optional<double> stretch;  ///< none where the chain has no length
};

const OutputTable& Skeleton::outputs() {
  using S = Skeleton;
  const auto solved = [](const S&, const State& s, double) { return s.f64(C::kSolved); };
  const auto marked = [](const S& k, const State&, double) { return *k.markers_; };
  const auto controls = [](const S& k, const State& s, double t) {
    return named(k.driver_.control_values(k.own_time(s, t), s.f64(C::kControl)));
  };
  const auto goal_names = [](const S& k) {
    std::vector<std::string> ids;
    for (const GoalDrive& g : k.model_.goals) ids.push_back(g.id);
    return ids;
  };
  const auto joint_names = [](const S& k) {
    return k.model_.joints.size() > kMostNamed ? std::vector<std::string>() : k.model_.ids;
  };
  const auto joint_places = [](const S&, const State& s, double, size_t joint) {
    return Place{load3(s.f64(C::kJointPosition).data(), joint)};
  };
  static const OutputTable kTable =
      OutputsOf<S>("a joint; of part bones a bone, of part skin a vertex")
          .part("", [](const S& k) { return points_part(k.model_.joints.size()); })
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(C::kJointPosition),
                 "of a joint, a bone's middle or a vertex")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(C::kJointVelocity),
                 "mean over the last step")
          .field({"orientation", "1", Scalar::f64, 4, Meaning::orientation}, column(C::kJointOrientation),
                 "w, x, y, z; a bone points along its y axis")
          .field({"value", ""}, computed_by<S>(&S::joint_values),
                 "rad of a revolute joint, m of a prismatic one, rotation angle in rad of a ball")
          .part("bones", [](const S& k) { return points_part(k.model_.bones.size()); })
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(kShownBones.position), "")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(kShownBones.velocity), "")
          .field({"orientation", "1", Scalar::f64, 4, Meaning::orientation}, column(kShownBones.orientation),
                 "")
          .field({"bones.angular_velocity", "rad/s", Scalar::f64, 3}, column(kShownBones.angular_velocity),
                 "of part bones: mean over the last step")
          .part("skin",
                [](const S& k) {
                  const size_t n = k.model_.skin.size();
                  return n > 0 ? std::optional(points_part(n)) : std::nullopt;
                })
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(C::kSkin), "")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(C::kSkinVelocity), "")
          .measured_each(control_names(&S::driver_), controls, kControlRows)
          .measured(
              solved,
              {{"ik.error", "m", entry<0>, "largest distance to a goal after the last step; with goals"},
               {"ik.iterations", "1", entry<1>, "of the solver in the last step; with goals"},
               {"ik.reached", "1", entry<2>, "1 where all goals are within the tolerance; with goals"}})
          .when([](const S& k) { return !k.model_.goals.empty(); })
          .measured_each(goal_names, &S::reached,
                         {{"goal.<id>.error", "m", &GoalReach::error, "distance to a goal"},
                          {"goal.<id>.stretch", "1", &GoalReach::stretch,
                           "distance of a goal from the start of its chain over the chain's length: at 1 the "
                           "chain is stretched and singular, above 1 the goal is out of reach"}})
          .measured_each(joint_names, joint_places,
                         {{"joint.<id>", "m", &Place::x, "position of a joint, in skeletons of at most 32"}})
          .measured(
              [](const S& k, const State& s, double) {
                return std::array{k.prior_distance(s), k.prior_.explained()};
              },
              {{"prior.distance", "1", entry<0>,
                "from the mean pose, in deviations of the prior's motion; with a prior"},
               {"prior.explained", "1", entry<1>,
                "share of that motion's variance in the components; with a prior"}})
          .when([](const S& k) { return !k.prior_.empty(); })
          .measured(marked,
                    {{"markers.error", "m", &MarkerReport::error,
                      "root mean square distance of markers from the fit; with markers"},
                     {"markers.seen", "1", &MarkerReport::seen, "share of markers in sight; with markers"},
                     {"markers.outliers", "1", &MarkerReport::outliers,
                      "positions in space and in images that were rejected; with markers"}})
          .when([](const S& k) { return k.markers_.has_value(); })
          .measured(marked, {{"markers.residual", "1", &MarkerReport::residual,
                              "pixels, in the images; with markers from cameras"}})
          .when([](const S& k) { return k.markers_ && k.markers_->residual > 0; })
          .measured(
              [](const S& k, const State& s, double) {
                return std::array{k.clip_.slide(), s.f64(C::kSolved)[3]};
              },
              {{"foot_lock.slide", "m", entry<0>,
                "largest slide of a standing foot in the recording, before locking"},
               {"foot_lock.error", "m", entry<1>,
                "largest distance of a locked foot from its fixed position"}})
          .when([](const S& k) { return k.clip_.feet() > 0; })
          .build();
  return kTable;
}

const Outputs& skeleton_outputs() {
  static const Outputs kDescribed = Skeleton::outputs().described();
  return kDescribed;
}

std::vector<Skeleton::GoalReach> Skeleton::reached(const State& s, double at) const {
  const double t = own_time(s, at);
  const double* x = s.f64(C::kJointPosition).data();
  Driver::Scratch scratch;
  const auto outputs = driver_.outputs_at(t, s.f64(C::kControl), scratch);
  std::vector<GoalReach> out;
  for (const GoalDrive& g : model_.goals) {
    const double* q = &s.f64(C::kJointOrientation)[4 * g.goal.joint];
    const Vec3 place = load3(x, g.goal.joint) + rotate({q[0], q[1], q[2], q[3]}, g.goal.point);
    const Vec3 target = goal(g, outputs).target;
    double length = norm(g.goal.point);
    for (uint32_t j = g.goal.joint; j != g.goal.base; j = static_cast<uint32_t>(model_.joints[j].parent))
      length += norm(model_.joints[j].rest.position);
    GoalReach& r = out.emplace_back(GoalReach{norm(target - place), {}});
    if (length > 0) r.stretch = norm(target - load3(x, g.goal.base)) / length;
  }
  return out;
}

double Skeleton::prior_distance(const State& s) const {
  std::vector<JointMotion> motion(model_.joints.size());
  std::vector<double> scratch;
  for (size_t j = 0; j < motion.size(); ++j) motion[j] = read_motion(&s.f64(C::kCoordinates)[8 * j]);
  return prior_.distance(motion, scratch);
}

void Skeleton::joint_values(const State& s, ShownRows rows, double* out) const {
  for (size_t j = 0; j < rows.count; ++j) {
    const double* c = &s.f64(C::kCoordinates)[8 * j];
    out[j] = model_.joints[j].kind == JointKind::ball
                 ? norm(free_rotation::rotation_vector(Quat{c[1], c[2], c[3], c[4]}))
                 : c[0];
  }
}

}  // namespace truestep::skeleton
