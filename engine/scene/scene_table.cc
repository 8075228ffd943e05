// The scene header's parameter tables.
#include "engine/scene/scene.h"

namespace truestep {

namespace {

const DefTable& time_table() {
  static const DefTable t =
      TableOf<TimeParams>("the clock: a fixed step, divided into substeps")
          .number("dt", &TimeParams::dt, "s", {.min = 1e-15, .max = kLongestDt},
                  "length of a session step; more than 10 s a substep for equations (ode) only")
          .integer("substeps", &TimeParams::substeps, between(1, 10000),
                   "equal parts that each step is computed in; without it one, or as many as the default "
                   "methods of "
                   "points that meet bodies need")
          .number("duration", &TimeParams::duration, "s", between(0, kLongestDuration),
                  "how long `truestep run` simulates")
          .integer("max_catchup_steps", &TimeParams::max_catchup_steps, between(1, 1000),
                   "most steps that a session which fell behind does at once before it skips time")
          .build();
  return t;
}

const DefTable& accuracy_table() {
  using A = AccuracyParams;
  static const DefTable t =
      TableOf<A>("how accurate the scene shall be; method and step are then chosen by measuring")
          .number("tolerance", &A::tolerance, "1", between(1e-14, 1), "relative error of the quantity")
          .required()
          .text("system", &A::system, "system that is meant; the first with an integrator when left out")
          .text("quantity", &A::quantity,
                "field whose error counts; state: all that says where the system is")
          .number("horizon", &A::horizon, "s", above(0), "time over which it counts; else the duration")
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
                  "place in a grid, between whose rows is interpolated; instead of index")
          .texts("fields", &ProbeParams::fields, {1, 16}, "fields to report")
          .build();
  return t;
}

const DefTable& recording_table() {
  static const DefTable t = TableOf<RecordingParams>("what goes into the recording")
                                .integer("every", &RecordingParams::every, between(1, 1e9),
                                         "steps from one recorded frame to the next")
                                .texts("fields", &RecordingParams::fields, {0, 16},
                                       "fields to record, of every system that has them; none: position, or "
                                       "all fields of a system without one")
                                .choice("precision", &RecordingParams::precision, {"f32", "f64"},
                                        "of recorded floating-point fields")
                                .build();
  return t;
}

const DefTable& camera_table() {
  static const DefTable t =
      TableOf<CameraParams>("where the picture is taken from")
          .vector("eye", &CameraParams::eye, "m", any(), "position of the camera")
          .vector("target", &CameraParams::target, "m", any(), "point in the middle of the picture")
          .vector("up", &CameraParams::up, "1", any(), "direction that is up in the picture")
          .number("fov", &CameraParams::fov, "rad", between(0.05, 2.5), "vertical angle of view")
          .build();
  return t;
}

const DefTable& slice_table() {
  static const DefTable t =
      TableOf<SliceParams>("where a grid in space is cut to be seen")
          .choice("axis", &SliceParams::axis, {"x", "y", "z"}, "that the cut is at right angles to")
          .number("at", &SliceParams::at, "m", any(), "place along it; without it in the middle")
          .build();
  return t;
}

const DefTable& viewer_table() {
  static const DefTable t =
      TableOf<ViewerParams>("how viewers show the scene")
          .object("camera", &ViewerParams::camera, camera_table(), "camera; without one the scene is framed")
          .text("color_by", &ViewerParams::color_by,
                "field that colours points or is shown of a grid, e.g. speed")
          .choice("color_map", &ViewerParams::color_map, {"viridis", "water", "ember"},
                  "colours from the lowest to the highest value")
          .numbers("range", &ViewerParams::range, "", any(), {0, 2},
                   "lowest and highest value of the colours; without it those of what is shown")
          .object("slice", &ViewerParams::slice, slice_table(),
                  "cut through a grid in space; without one it is shown as translucent slices")
          .number("height", &ViewerParams::height, "", any(),
                  "m per unit: values of a grid in the plane stand out of it as a surface")
          .choice("liquid", &ViewerParams::liquid, {"balls", "surface"},
                  "how particles that have a size are drawn: each as a ball, or in space all of a system as "
                  "the smooth "
                  "surface of the liquid that they are")
          .integer("contours", &ViewerParams::contours, between(0, 64),
                   "level lines of a grid in the plane or a slice")
          .integer("streamlines", &ViewerParams::streamlines, between(0, 400),
                   "lines along a vector field of a grid in the plane or a slice")
          .check([](const ViewerParams& v, const DefTable::Report& report) {
            if (v.range.size() == 1 || (v.range.size() == 2 && !(v.range[0] < v.range[1])))
              report("/range", "two numbers, the lower first");
          })
          .build();
  return t;
}

const DefTable& expect_table() {
  static const DefTable t =
      TableOf<ExpectParams>("what a run of this scene should measure")
          .text("quantity", &ExpectParams::quantity,
                "an observable at the end, or min(...), max(...), drift(...) of one over the run's steps. "
                "Drift: "
                "largest change since the start, divided by the largest magnitude at the start among the "
                "quantities of its group with its unit (energy.*: J); not divided, so absolute, where all of "
                "them start at 0. energy.drift is drift(energy.total)")
          .required()
          .number("min", &ExpectParams::min, "", any(), "lower bound")
          .number("max", &ExpectParams::max, "", any(), "upper bound")
          .number("equals", &ExpectParams::equals, "", any(), "value, to within tolerance")
          .number("tolerance", &ExpectParams::tolerance, "", at_least(0), "allowed difference from equals")
          .text("source", &ExpectParams::source, "where the number comes from")
          .check([](const ExpectParams& e, const DefTable::Report& report) {
            if (!e.min && !e.max && !e.equals) report("", "an expectation needs min, max or equals");
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
          .text("title", &SceneHeader::title, "one line for people")
          .text("teaches", &SceneHeader::teaches, "what to see in it")
          .texts("tags", &SceneHeader::tags, {0, 32}, "words to find it by")
          .integer("seed", &SceneHeader::seed, between(0, 9007199254740992.0), "seed of every random draw")
          .vector("gravity", &SceneHeader::gravity, "m/s^2", {-1e6, 1e6}, "acceleration of free fall")
          .object("time", &SceneHeader::time, time_table(), "the clock")
          .object("accuracy", &SceneHeader::accuracy, accuracy_table(),
                  "instead of a method and a step: how accurate")
          .texts("observables", &SceneHeader::observables, {0, 64},
                 "observables to keep over time (names or their beginnings up to a dot), at every step; a "
                 "session "
                 "keeps energy and probes in any case; none: recordings and --csv keep all")
          .objects("probes", &SceneHeader::probes, probe_table(), {0, 256},
                   "rows whose fields become observables")
          .object("recording", &SceneHeader::recording, recording_table(),
                  "what is recorded; without it, nothing")
          .choice("on_instability", &SceneHeader::on_instability, {"pause", "stop"},
                  "what happens when a state becomes non-finite")
          .boolean("keep_running", &SceneHeader::keep_running,
                   "a session that plays goes on when its last viewer has left")
          .object("viewer", &SceneHeader::viewer, viewer_table(), "how viewers show the scene")
          .objects("expect", &SceneHeader::expect, expect_table(), {0, 64}, "what a run should measure")
          .check([](const SceneHeader& h, const DefTable::Report& report) {
            if (h.schema_version != "1.0")
              report("/schema_version", "this version reads scenes of version \"1.0\"");
          })
          .build();
  return t;
}

}  // namespace truestep
