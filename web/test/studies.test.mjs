// What the page of studies computes: axes, numbers, sentences, the request that a form makes, the table's order.
import assert from "node:assert/strict";
import { test } from "node:test";
import { accuracyWords, cellText, curveName, duration, fieldOf, isUseful, makeAxis, modelOf, numberPointers, place, placeholderOf, power, quantity, readDraft, rowOf, sorted, splitLabel, systemsOf, valueOf, wordsOf } from "../build/studies.mjs";

test("powers of ten, quantities and times are short", () => {
  assert.deepEqual([0, 2, 3, -6, -12].map(power), ["1", "100", "10³", "10⁻⁶", "10⁻¹²"]);
  assert.equal(quantity(4.5664e-10), "4.57·10⁻¹⁰");
  assert.equal(quantity(1e-6), "10⁻⁶");
  assert.equal(quantity(-2.5e9), "−2.5·10⁹");
  assert.equal(quantity(51624.7), "51,600");
  assert.equal(quantity(Number.NaN), "–");
  assert.deepEqual([3.447e-5, 0.002, 120, 1e-6, 0].map((t) => duration(t)), ["34.5 µs", "2 ms", "120 s", "1 µs", "0 s"]);
  assert.equal(cellText(null, "s"), "–");
  assert.equal(cellText(30720, "1"), "30,720");
  assert.equal(cellText(3.3e-5, "s", "cpu_seconds"), "33 µs");
});

test("a logarithmic axis holds its values and labels whole decades", () => {
  const axis = makeAxis([1e-12, 3e-4, null, -1, 0], "log", 6);
  assert.ok(axis.min < 1e-12 && axis.max > 3e-4);
  assert.ok(Math.abs(place(axis, axis.min)) < 1e-12 && Math.abs(place(axis, axis.max) - 1) < 1e-12);
  assert.ok(axis.ticks.length >= 3 && axis.ticks.length <= 8, axis.ticks.length);
  for (const tick of axis.ticks) assert.match(tick.label, /^(1|10|100|10⁻?[⁰-⁹¹²³]+)$/);
  // Equal ratios are equal distances; on a linear axis they are not.
  const gap = (scale, a, b) => place(makeAxis([1e-12, 1e-2], scale, 5), b) - place(makeAxis([1e-12, 1e-2], scale, 5), a);
  assert.ok(Math.abs(gap("log", 1e-10, 1e-9) - gap("log", 1e-4, 1e-3)) < 1e-9);
  assert.ok(Math.abs(gap("linear", 1e-10, 1e-9) - gap("linear", 1e-4, 1e-3)) > 1e-4);
});

test("a range of less than a decade still has labels, and so has a single value", () => {
  assert.ok(makeAxis([2.1e-5, 4.9e-5], "log", 6, "s").ticks.some((tick) => tick.label === "50 µs" || tick.label === "20 µs"));
  for (const scale of ["log", "linear"]) {
    const axis = makeAxis([3], scale, 5);
    assert.ok(axis.min < 3 && axis.max > 3 && axis.ticks.length > 0, scale);
  }
  assert.ok(makeAxis([], "log", 5).max > 0);
});

test("linear labels are round numbers inside the range", () => {
  const { ticks, min, max } = makeAxis([0, 6], "linear", 6, "s");
  assert.deepEqual(ticks.map((tick) => tick.label), ["0 s", "2 s", "4 s", "6 s"]);
  assert.ok(ticks.every((tick) => tick.at >= min && tick.at <= max));
});

const parameters = [
  { name: "integrators", kind: "strings" },
  { name: "tolerances", kind: "numbers" },
  { name: "horizon", kind: "number", unit: "s" },
  { name: "a", kind: "object", parameters: [{ name: "integrator", kind: "string" }, { name: "dt", kind: "number" }] },
  { name: "b", kind: "object", parameters: [{ name: "integrator", kind: "string" }] },
  { name: "axes", kind: "objects", required: true, parameters: [{ name: "pointer", kind: "string", required: true }, { name: "values", kind: "numbers" }] },
];

test("a filled form becomes a request, and empty fields stay out of it", () => {
  const draft = new Map([["/integrators", "rk4,dopri5"], ["/tolerances", "1e-3 1e-6, 1e-9"], ["/horizon", " 2.5 "], ["/a/dt", "0.01"], ["/b/integrator", " "], ["/axes#", "2"], ["/axes/0/pointer", "/systems/0/mass"], ["/axes/1/values", "1;2"]]);
  assert.deepEqual(readDraft(parameters, draft), {
    integrators: ["rk4", "dopri5"],
    tolerances: [1e-3, 1e-6, 1e-9],
    horizon: 2.5,
    a: { dt: 0.01 },
    axes: [{ pointer: "/systems/0/mass" }, { values: [1, 2] }],
  });
  assert.deepEqual(readDraft(parameters.slice(0, 5), new Map()), {});
});

test("what is no number reaches the service as it was written", () => {
  assert.equal(valueOf("number", "5 ms"), "5 ms");
  assert.deepEqual(valueOf("numbers", "1 ms, 2 ms"), ["1 ms", "2 ms"]);
  assert.equal(valueOf("integer", "12"), 12);
});

const scene = { time: { dt: 0.01, duration: 2 }, systems: [{ id: "ten", type: "particles", mass: 1, positions: Array.from({ length: 50 }, () => [0, 0, 0]), "odd/name": { k: 3 } }, { type: "rope" }] };

test("a scene offers its numbers, systems and duration", () => {
  assert.deepEqual(numberPointers(scene), ["/systems/0/mass", "/systems/0/odd~1name/k", "/time/dt", "/time/duration"]);
  assert.deepEqual(systemsOf(scene), [{ id: "ten", type: "particles" }, { id: "rope", type: "rope" }]);
  assert.equal(placeholderOf({ name: "horizon", kind: "number" }, scene), "2");
  assert.equal(placeholderOf({ name: "budget", kind: "number", default: 40 }, scene), "40");
  assert.deepEqual(numberPointers(undefined), []);
});

test("useful parameters come first, and an issue finds the field it lies in", () => {
  assert.ok(isUseful({ name: "horizon", kind: "number" }) && isUseful({ name: "other", kind: "text", required: true }));
  assert.ok(!isUseful({ name: "samples", kind: "integer" }));
  assert.equal(fieldOf("/axes/0/pointer", ["/axes", "/axes/0", "/a"]), "/axes/0");
  assert.equal(fieldOf("/axesx", ["/axes"]), undefined);
});

const study = {
  summary: {
    kind: "work_precision", scene: "terminal velocity", horizon: 1,
    reference: { method: "step_doubling at tolerance 1e-13", checked_by: "dopri5 at tolerance 1e-12", uncertainty: 9e-15 },
    cheapest: [{ error: 1e-2, integrator: "euler", cpu_seconds: 3e-5 }, { error: 1e-8, integrator: "rk4", cpu_seconds: 4e-5 }],
    refused: [{ integrator: "newmark", reason: "needs a mass matrix" }],
  },
  columns: [{ name: "integrator", unit: "" }, { name: "cpu_seconds", unit: "s" }, { name: "error_end", unit: "1" }, { name: "status", unit: "" }],
  rows: [
    { integrator: "euler", cpu_seconds: 3e-5, error_end: 1e-2, status: "ok" },
    { integrator: "rk4", cpu_seconds: 4e-5, error_end: 1e-9, status: "ok" },
    { integrator: "rk4", cpu_seconds: null, error_end: null, status: "over budget" },
  ],
  plot: {
    title: "Run time against error", x_label: "relative error of position at the end", y_label: "CPU time in s", x_scale: "log", y_scale: "log",
    series: [{ name: "euler", x: [1e-2], y: [3e-5] }, { name: "rk4", x: [1e-9, null, 0], y: [4e-5, 1, 2] }, ...["a", "b", "c", "d", "e"].map((name) => ({ name, x: [1e-3], y: [1] }))],
  },
};

test("a work-precision study is told in sentences", () => {
  const words = wordsOf(study);
  assert.deepEqual(words.winners.map(({ error, method }) => [error, method]), [["10⁻²", "euler"], ["10⁻⁸", "rk4"]]);
  assert.match(words.findings.join(" "), /euler .*coarse.* rk4/);
  assert.match(words.basis.join(" "), /step_doubling.*agree to 9·10⁻¹⁵.*below 9·10⁻¹⁴/);
  assert.match(words.basis.join(" "), /1 curve ended early/);
  assert.deepEqual(words.refused, [{ method: "newmark", reason: "needs a mass matrix" }]);
  assert.deepEqual(words.warnings, []);
  assert.deepEqual(wordsOf({ ...study, summary: { ...study.summary, warning: "the motion is chaotic" } }).warnings, ["The motion is chaotic."]);
});

test("an order that did not settle is a warning, and so is one below the promise", () => {
  const of = (summary) => wordsOf({ ...study, rows: [], summary: { kind: "convergence", integrator: "rk4", promised_order: 4, ...summary } });
  assert.match(of({ observed_order: null, reason: "errors are at the floor" }).warnings[0], /floor/);
  assert.match(of({ observed_order: 2.01 }).warnings[0], /below the promised 4/);
  assert.deepEqual(of({ observed_order: 3.98 }).warnings, []);
});

test("the drawing leaves out what a logarithm cannot show, and puts the winners in front", () => {
  const model = modelOf(study);
  assert.deepEqual(model.front, ["euler", "rk4"]);
  assert.deepEqual(model.curves[1].points, [{ x: 1e-9, y: 4e-5 }]);
  assert.deepEqual(splitLabel(study.plot.y_label), { label: "CPU time", unit: "s" });
  assert.equal(rowOf(study, model, model.curves[1], model.curves[1].points[0]), study.rows[1]);
  assert.equal(rowOf(study, model, model.curves[0], model.curves[1].points[0]), undefined);
});

test("a requested accuracy says which method it led to", () => {
  const report = { tolerance: 1e-6, quantity: "position", chosen: { integrator: "rkf45", tolerance: 1e-5, error: 6.9e-8 }, measured: [1, 2, 3] };
  assert.equal(accuracyWords(report), "rkf45 at tolerance 10⁻⁵ is the cheapest of 3 runs measured whose error of position stays within 10⁻⁶, measured 6.9·10⁻⁸.");
  assert.match(accuracyWords({ tolerance: 1e-3, chosen: { integrator: "rk4", step: 0.002 }, note: "the scene is chaotic" }), /^rk4 with a step of 2 ms .* 10⁻³\. The scene is chaotic\.$/);
});

test("curves of a sweep are named by the end of their pointers", () => {
  assert.equal(curveName("/systems/0/quadratic_drag = 5E-2, /time/dt = 1.25E-3"), "quadratic_drag = 0.05, dt = 0.00125");
  assert.equal(curveName("velocity_verlet"), "velocity_verlet");
});

test("a stability study is drawn with a line a method", () => {
  const rows = [{ integrator: "euler", largest_stable_dt: 1e-3, theory_dt: 0 }, { integrator: "rk4", largest_stable_dt: null, theory_dt: null }, { integrator: "heun", largest_stable_dt: 2e-3, theory_dt: 2e-3 }];
  const model = modelOf({ ...study, summary: { kind: "stability" }, rows });
  assert.deepEqual(model.categories, ["euler", "heun"]);
  assert.deepEqual(model.curves.map((curve) => curve.points.length), [1, 2]);
});

test("a column sorts as numbers, both ways, with missing values last", () => {
  const errors = (direction) => sorted(study.rows, "error_end", direction).map((row) => row.error_end);
  assert.deepEqual(errors(1), [1e-9, 1e-2, null]);
  assert.deepEqual(errors(-1), [1e-2, 1e-9, null]);
});
