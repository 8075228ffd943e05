#include "engine/systems/skeleton/motion_def.h"

namespace truestep::skeleton {

namespace {

const DefTable& foot_lock_table() {
  using D = FootLockDef;
  static const DefTable t =
      TableOf<D>("keeps standing feet in place: low and slow joints are fixed by the two bones above them")
          .texts("joints", &D::joints, {1, 16}, "the feet")
          .required()
          .number("height", &D::height, "m", any(), "a standing foot is below this")
          .number("speed", &D::speed, "m/s", above(0), "a standing foot is slower than this")
          .number("blend", &D::blend, "s", at_least(0), "over which a foot is locked or released")
          .build();
  return t;
}

const DefTable& placement_table() {
  using D = PlacementDef;
  static const DefTable t = TableOf<D>("position of a marker on the body")
                                .text("marker", &D::marker, "its name in the file or the images")
                                .required()
                                .text("joint", &D::joint, "joint that it moves with")
                                .required()
                                .vector("point", &D::point, "m", any(), "in the joint's frame")
                                .build();
  return t;
}

const DefTable& camera_table() {
  using D = CameraDef;
  static const DefTable t =
      TableOf<D>("a camera without distortion")
          .text("name", &D::name, "its name in the images")
          .required()
          .vector("position", &D::position, "m", any(), "of its centre")
          .required()
          .vector("target", &D::target, "m", any(), "a point in the centre of its image")
          .required()
          .vector("up", &D::up, "1", any(), "direction that is up in its image")
          .number("focal", &D::focal, "1", above(0), "focal length in pixels")
          .number("middle_u", &D::middle_u, "1", any(), "pixels, of the image centre, to the right")
          .number("middle_v", &D::middle_v, "1", any(), "pixels, of the image centre, downwards")
          .check([](const D& d, const DefTable::Report& report) {
            if (!(norm(d.target - d.position) > 0))
              report("/target", "the camera's target equals its position");
            if (!(norm(d.up) > 0)) report("/up", "up must not be zero");
          })
          .build();
  return t;
}

const DefTable& markers_table() {
  using D = MarkersDef;
  static const DefTable t =
      TableOf<D>("optical markers to which the skeleton is fitted by least squares")
          .texts("trc", &D::trc, {0, 1'000'000}, "lines of a TRC file")
          .objects("cameras", &D::cameras, camera_table(), {0, 256}, "cameras, instead of a file")
          .texts("images", &D::images, {0, 1'000'000},
                 "their observations: lines of frame, camera, marker, u and v (pixels, right and down)")
          .number("rate", &D::rate, "1/s", above(0), "frames of the cameras")
          .objects("placements", &D::placements, placement_table(), {1, 10'000},
                   "positions of markers on the body")
          .required()
          .check([](const D& d, const DefTable::Report& report) {
            if (d.trc.empty() == d.images.empty())
              report("", "markers come from either a TRC file or images");
            if (!d.images.empty() && d.cameras.size() < 2) report("/cameras", "positions need two cameras");
          })
          .build();
  return t;
}

}  // namespace

const DefTable& motion_table() {
  using D = MotionDef;
  static const DefTable t =
      TableOf<D>("recorded motion: a BVH or glTF file line by line, or markers")
          .texts("bvh", &D::bvh, {0, 1'000'000}, "lines of a BVH file")
          .texts("gltf", &D::gltf, {0, 1'000'000},
                 "a .gltf file with embedded data, or a .glb file in base64, with any line breaks")
          .text("animation", &D::animation, "of the glTF file; absent: the first")
          .number("rate", &D::rate, "1/s", between(0.1, 10'000), "at which the glTF file is sampled")
          .object("markers", &D::markers, markers_table(), "optical markers instead of a file")
          .number("scale", &D::scale, "m", above(0), "length of the file's unit: 0.01 for centimetres")
          .named_texts(
              "names", &D::names, {0, kMostJoints},
              "joint of the file: joint of this skeleton that takes its rotations; absent: the same names")
          .number("root_scale", &D::root_scale, "1", above(0),
                  "of the root's translation; absent: the ratio of the two skeletons' sizes")
          .choice("extend", &D::extend, {"clamp", "loop", "ping_pong"}, "after the last frame")
          .number("smoothing", &D::smoothing, "s", at_least(0), "width of a Gaussian mean over time")
          .object("foot_lock", &D::foot_lock, foot_lock_table(), "feet to lock while they stand")
          .check([](const D& d, const DefTable::Report& report) {
            const int given = (d.bvh.empty() ? 0 : 1) + (d.gltf.empty() ? 0 : 1) + (d.markers ? 1 : 0);
            if (given != 1) report("", "a motion comes from exactly one of bvh, gltf and markers");
          })
          .build();
  return t;
}

const DefTable& layer_table() {
  using D = LayerDef;
  static const DefTable t =
      TableOf<D>("a recorded motion blended over those before it")
          .object("motion", &D::motion, motion_table(), "its file; foot_lock is that of the first motion")
          .required()
          .expression("weight", &D::weight, "of t and controls, from 0 to 1")
          .required()
          .choice("mode", &D::mode, {"cross_fade", "additive"},
                  "cross_fade: from the motions before it to this one; additive: its change since its first "
                  "frame is added")
          .check([](const D& d, const DefTable::Report& report) {
            if (d.motion.markers) report("/motion/markers", "only the first motion takes markers");
          })
          .build();
  return t;
}

const DefTable& prior_table() {
  using D = PriorDef;
  static const DefTable t =
      TableOf<D>("a normal distribution of poses, learnt from a motion; goals take the likeliest pose")
          .object("motion", &D::motion, motion_table(), "motion that it is learnt from")
          .required()
          .integer("components", &D::components, between(1, 1000), "principal components, at most")
          .number("variation", &D::variation, "", above(0),
                  "rad or m, smallest deviation of a coordinate from the components")
          .number("spread", &D::spread, "m", above(0),
                  "by which goals may be missed before the solver refines")
          .check([](const D& d, const DefTable::Report& report) {
            if (d.motion.markers) report("/motion/markers", "a prior must be learnt from a file");
          })
          .build();
  return t;
}

}  // namespace truestep::skeleton
