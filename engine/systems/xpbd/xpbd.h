// The system type "xpbd": cloth, ropes, hair and soft blocks by extended position-based dynamics (Macklin,
// Mueller, Chentanez 2016), with the scene's stiffness in N/m, or by position-based dynamics (Mueller,
// Heidelberger, Hennix, Ratcliff 2007), whose stiffness depends on step and iterations. A step is divided
// into substeps of one iteration each (Macklin et al. 2019); links in line are solved directly. First order
// in time and dissipative, like implicit Euler: the faster a motion, the more it is damped. Ropes and hair
// may be Cosserat rods (rod_set.h), cloth may tear (tear_surface.h), blocks have springs, an elastic material
// (kernels/xpbd/neo_hookean.h) or a shape that they are pulled back to (match_set.h). Commands: push,
// impulse, drag, release, pin, unpin, set_parameter (stiffness, shear_stiffness, youngs_modulus,
// bending_rigidity, flexural_rigidity, bulk_modulus, damping, internal_damping, gravity, and wind if the
// scene has one).
#pragma once
#include <memory>

#include "engine/core/outputs/tabled.h"
#include "engine/core/ports/changing_triangles.h"
#include "engine/core/ports/pressed_points.h"
#include "engine/systems/xpbd/solver.h"

namespace truestep::xpbd {

class Xpbd final : public Tabled<Xpbd, StagedSystem>, public ChangingTriangles, public PressedPoints {
 public:
  Xpbd(const XpbdDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  State initial_state() const override;
  void check(StateCheck& check, double t) const override;
  void warn(const State& state, double h, std::vector<Warning>& out) const override;
  void apply(State& state, const Command& command) const override;
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  Ports ports() const override;
  std::span<const std::array<uint32_t, 3>> triangles(const State& state) const override;
  std::optional<double> limit(Limit which, const State& state, double h) const override;
  std::optional<Energy> energy(const State& state, double t, Workspace& workspace,
                               const ThreadArena& arena) const override;

  double pressed_h(double mass) const override;

  const RodSet& rods() const { return rods_; }
  const Body& body() const { return body_; }
  int substeps() const { return options_.substeps; }
  int iterations() const { return options_.iterations; }
  const Schedule& schedule() const { return schedule_; }

 private:
  struct Whole;
  Whole whole(const State& state, double t) const;
  /// Of links, with the sign, and of points, the largest of their links'.
  void link_strains(const State& state, ShownRows rows, double* out) const;
  void point_strains(const State& state, ShownRows rows, double* out) const;
  /// Adds what frames of rods that turn have.
  void add_turning(const State& state, Vec3& angular_momentum) const;
  template <class Visit>
  void each_strand(const State& state, const Visit& visit) const;
  /// Of the constant part of the drawing.
  uint32_t drawing_version(const State& state) const;
  /// kg, of every row.
  std::span<const double> masses(const State& state) const;
  size_t strands(size_t link) const { return tears_ ? tears_->sides(link) : 1; }
  Strand strand(const State& state, size_t link, size_t side) const;
  void plan_stages(const XpbdDef& def, const std::string& why);
  void publish();
  static double strain(const double* x, const Link& link, const Strand& strand);
  double elastic(const State& state) const;
  /// J, of stretch and shear, of bending, of twist.
  Vec3 rod_energies(const State& state) const;
  Energy energies(const State& state) const;
  double default_drag(const State& state, size_t row) const;
  void set_parameter(State& state, const Command& command) const;

  Vec3 gravity_, velocity_, wind_;
  double damping_[2];
  bool youngs_;    // link stiffnesses are moduli
  bool elastic_;   // tetrahedra have an elastic material, and there are no links
  bool membrane_;  // triangles have an elastic material, and there are no links
  bool cosserat_;  // links belong to rods, whose moduli stay
  Precision precision_;
  Body body_;
  RodSet rods_;
  MatchSet matches_;
  std::vector<Tether> tethers_;
  std::vector<AttachmentDef> attachments_;
  std::optional<TearSurface> tears_;
  TearLimits tear_limits_;
  Schedule schedule_;
  SolverOptions options_;
  double longest_substep_ = HUGE_VAL;  // s, of elastic materials whose substeps the scene names
  ColliderSet colliders_;
  std::vector<Surface> surfaces_;  // one per collider
  std::optional<FoldSurface> folds_;
  std::optional<AirDrag> air_;
  PartDrawing drawing_;
  std::vector<std::array<uint32_t, 2>> segments_;  // published if there are no triangles
  double speed_limit_ = 0;
  double substep_;       // s, of its own
  double step_seconds_;  // on one core, estimated
};

std::unique_ptr<const System> build_xpbd(const void* def, const BuildContext& context);

}  // namespace truestep::xpbd
