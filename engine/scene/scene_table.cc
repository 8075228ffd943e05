// The scene header's parameter tables.
#include "engine/scene/scene.h"

#include "engine/math/expression/names.h"
#include "engine/scene/expected_quantity.h"

namespace truestep {

namespace {

const DefTable& time_table() {
  static const DefTable t =
      TableOf<TimeParams>("the clock: a fixed step, divided into substeps")
          .number("dt", &TimeParams::dt, "s", {.min = 1e-15, .max = kLongestDt},
                  "length of a session step; more than 10 s per substep only for equations (ode)")
          .integer(
              "substeps", &TimeParams::substeps, between(1, 10000),
              "equal parts of each step; without it one, or as many as bodies in a medium and the default "
              "methods of points in contact with bodies need")
          .number("duration", &TimeParams::duration, "s", between(0, kLongestDuration),
                  "how long `truestep run` simulates")
          .integer("max_catchup_steps", &TimeParams::max_catchup_steps, between(1, 1000),
                   "most steps at once for a session that fell behind, before it skips time")
          .build();
  return t;
}

const DefTable& accuracy_table() {
  using A = AccuracyParams;
  static const DefTable t =
      TableOf<A>("required accuracy; method and step are then chosen by measurement")
          .number("tolerance", &A::tolerance, "1", between(1e-14, 1), "relative error of the quantity")
          .required()
          .text("system", &A::system, "system to measure; the first with an integrator when left out")
          .text("quantity", &A::quantity, "field whose error counts; state: all coordinates of the system")
          .number("horizon", &A::horizon, "s", above(0),
                  "time over which the error counts; else the duration")
          .build();
  return t;
}

const DefTable& probe_table() {
  static const DefTable t =
      TableOf<ProbeParams>("a row whose fields become observables")
          .text("id", &ProbeParams::id, "name of the probe")
          .required()
          .text("system", &ProbeParams::system, "id of the system")
          .required()
          .integer("index", &ProbeParams::index, between(-1e9, 1e9), "row; -1 is the last one")
          .vector("at", &ProbeParams::at, "m", any(),
                  "position in a grid, interpolated between rows; instead of index")
          .choice("rows", &ProbeParams::rows, {"one", "least", "greatest", "mean"},
                  "one: the row `index`; else the least, greatest or mean value of all rows from `index` on, "
                  "component by component")
          .texts("fields", &ProbeParams::fields, {1, 16}, "fields to report")
          .build();
  return t;
}

const DefTable& recording_table() {
  static const DefTable t = TableOf<RecordingParams>("contents of the recording")
                                .integer("every", &RecordingParams::every, between(1, 1e9),
                                         "steps from one recorded frame to the next")
                                .texts("fields", &RecordingParams::fields, {0, 16},
                                       "fields to record, of every system that has them; none: position, or "
                                       "all fields of a system without position")
                                .choice("precision", &RecordingParams::precision, {"f32", "f64"},
                                        "of recorded floating-point fields")
                                .build();
  return t;
}

const DefTable& camera_table() {
  static const DefTable t =
      TableOf<CameraParams>("viewpoint of the picture")
          .vector("eye", &CameraParams::eye, "m", any(), "position of the camera")
          .vector("target", &CameraParams::target, "m", any(), "point at the centre of the picture")
          .vector("up", &CameraParams::up, "1", any(), "direction that is up in the picture")
          .number("fov", &CameraParams::fov, "rad", between(0.05, 2.5), "vertical angle of view")
          .build();
  return t;
}

const DefTable& slice_table() {
  static const DefTable t =
      TableOf<SliceParams>("cut through a grid in space to show")
          .choice("axis", &SliceParams::axis, {"x", "y", "z"}, "axis perpendicular to the cut")
          .number("at", &SliceParams::at, "m", any(), "position along the axis; without it in the middle")
          .build();
  return t;
}

const DefTable& viewer_table() {
  static const DefTable t =
      TableOf<ViewerParams>("how viewers show the scene")
          .object("camera", &ViewerParams::camera, camera_table(), "camera; without one the scene is framed")
          .text("color_by", &ViewerParams::color_by,
                "field that colours points, lines, triangles or joints, or the field of a grid to show, e.g. "
                "speed")
          .text("legend", &ViewerParams::legend,
                "what the colours of `color_by` show; without it the name of the field. Its unit follows")
          .choice(
              "color_map", &ViewerParams::color_map,
              {"automatic", "viridis", "water", "ember", "balance", "smoke", "snow", "sand"},
              "colour map from the lowest to the highest value; balance is for what deviates to both sides "
              "of zero, and automatic is that for such fields, otherwise viridis")
          .texts(
              "names", &ViewerParams::names, {0, 32},
              "of the values 0, 1, 2 ... of `color_by`: each has a colour of its own, and a legend instead "
              "of a colour bar")
          .numbers("range", &ViewerParams::range, "", any(), {0, 2},
                   "lowest and highest value of the colours; without it those of the data shown")
          .object("slice", &ViewerParams::slice, slice_table(),
                  "cut through a grid in space; without one it is shown as translucent slices")
          .number("height", &ViewerParams::height, "", any(),
                  "m per unit: draws values of a plane grid as a surface above it")
          .choice("liquid", &ViewerParams::liquid, {"balls", "surface"},
                  "how particles with a size are drawn: each as a ball, or in space all of a system as one "
                  "smooth liquid surface")
          .integer("contours", &ViewerParams::contours, between(0, 64),
                   "level lines of a grid in the plane or a slice")
          .integer("streamlines", &ViewerParams::streamlines, between(0, 400),
                   "lines along a vector field of a grid in the plane or a slice")
          .boolean("labels", &ViewerParams::labels,
                   "names above the systems where there are two to eight of them; false: none")
          .boolean("probe_labels", &ViewerParams::probe_labels, "names of probes beside what they watch")
          .number("trail", &ViewerParams::trail, "s", above(0),
                  "for how long points leave a trail; of up to 64 points a system")
          .check([](const ViewerParams& v, const DefTable::Report& report) {
            if (!v.legend.empty() && v.color_by.empty())
              report("/legend", "it says what the colours of `color_by` show: give that, too");
            if (v.range.size() == 1 || (v.range.size() == 2 && !(v.range[0] < v.range[1])))
              report("/range", "two numbers, the lower first");
            if (!v.names.empty() && v.color_by.empty())
              report("/names", "they are names of the values of `color_by`: give that, too");
          })
          .build();
  return t;
}

const DefTable& expect_table() {
  static const DefTable t =
      TableOf<ExpectParams>("what a run of this scene should measure")
          .text("quantity", &ExpectParams::quantity,
                "an observable at the end, or what the run did with it: min(...), max(...), mean(...), "
                "start(...), largest(...) = max |x|, change(...) = max |x - start|, drift(...); or an "
                "expression of such, e.g. \"max(tip.position.y) - start(top.position.y)\" or "
                "\"largest(tip.position.x - cos(2*t))\", t = time. Drift: change divided by the largest "
                "magnitude at the start among the quantities of its group with its unit (energy.*: J); "
                "absolute where all of them start at 0. energy.drift is drift(energy.total). energy.gain and "
                "energy.loss: the most that energy.total rises above or falls below its start, divided by "
                "the energy at work, i.e. kinetic at the start + the fall of the potential + `given`")
          .required()
          .number("min", &ExpectParams::min, "", any(), "lower bound")
          .number("max", &ExpectParams::max, "", any(), "upper bound")
          .number("equals", &ExpectParams::equals, "", any(), "value, to within tolerance")
          .number("tolerance", &ExpectParams::tolerance, "", at_least(0), "allowed difference from equals")
          .number("from", &ExpectParams::from, "s", at_least(0), "values before this time do not count")
          .number("until", &ExpectParams::until, "s", at_least(0),
                  "values after this time do not count: the end, for this expectation")
          .number(
              "given", &ExpectParams::given, "J", at_least(0),
              "of energy.gain and energy.loss: what motors, emitters or springs may add that energy.total "
              "does not count at the start")
          .text("source", &ExpectParams::source, "source of the number")
          .check([](const ExpectParams& e, const DefTable::Report& report) {
            if (!e.min && !e.max && !e.equals) report("", "an expectation needs min, max or equals");
            try {
              static_cast<void>(ExpectedQuantity(e.quantity));
            } catch (const ExpressionFault& fault) {
              report("/quantity", describe(fault, e.quantity));
            }
          })
          .build();
  return t;
}

}  // namespace

const DefTable& scene_table() {
  static const DefTable t =
      TableOf<SceneHeader>("a scene")
          .text("$schema", &SceneHeader::schema, "address of the JSON Schema")
          .text("schema_version", &SceneHeader::schema_version, "version of the scene format, 1.0")
          .text("name", &SceneHeader::name, "name of the scene")
          .text("title", &SceneHeader::title, "one-line description")
          .text("teaches", &SceneHeader::teaches, "what to see in it")
          .texts("tags", &SceneHeader::tags, {0, 32}, "search words")
          .integer("seed", &SceneHeader::seed, between(0, 9007199254740992.0), "seed of every random draw")
          .vector("gravity", &SceneHeader::gravity, "m/s^2", {-1e6, 1e6}, "gravitational acceleration")
          .object("time", &SceneHeader::time, time_table(), "the clock")
          .object("accuracy", &SceneHeader::accuracy, accuracy_table(),
                  "required accuracy, instead of a method and a step")
          .texts("observables", &SceneHeader::observables, {0, 64},
                 "observables to keep at every step (names or their beginnings up to a dot); a session "
                 "always keeps energy and probes; none: recordings and --csv keep all")
          .objects("probes", &SceneHeader::probes, probe_table(), {0, 256},
                   "rows whose fields become observables")
          .object("recording", &SceneHeader::recording, recording_table(),
                  "recording; without it, nothing is recorded")
          .choice("on_instability", &SceneHeader::on_instability, {"pause"},
                  "a state that becomes unstable is not kept: the session pauses at its last good step")
          .boolean("keep_running", &SceneHeader::keep_running,
                   "a playing session continues when its last viewer has left")
          .object("viewer", &SceneHeader::viewer, viewer_table(), "how viewers show the scene")
          .objects("expect", &SceneHeader::expect, expect_table(), {0, 64}, "results that a run should give")
          .check([](const SceneHeader& h, const DefTable::Report& report) {
            if (h.schema_version != "1.0")
              report("/schema_version", "this program reads scenes of version \"1.0\"");
          })
          .build();
  return t;
}

}  // namespace truestep
