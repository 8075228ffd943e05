// What the viewer computes before it draws: where a camera sees everything, axes, level lines, gaps of plots, speeds,
// addresses. Pure functions, in Node.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { arrows, axisOf, balanced, chapterOf, chooseAtFirst, colorStops, endsOf, evenStreamlines, Extent, gapsIn, infoOf, kindAt, levelLine, matches, packScene, particleSurface, placeOf, readAddress, relative, scaleLabel, scaleOf, schemeOf, speedAtFirst, speedsFor, streamline, tickTexts, timeText, triangleValues, unpackScene, fieldsOf, JointValues, jointValues, Past, upOf, writeAddress } from "../build/view.mjs";

const front = { right: [1, 0, 0], above: [0, 1, 0], back: [0, 0, 1] };

test("a camera is as near as it can be and sees every ball", () => {
  const extent = new Extent();
  for (let k = 0; k < 200; ++k) extent.add(Math.sin(12.9898 * k) * 3, Math.sin(78.233 * k), Math.sin(37.719 * k) * 2, 0.1);
  for (const [kx, ky] of [[0.5, 0.3], [0.1, 0.4]]) {
    const frustum = { ...front, kx, ky };
    const { eye, target } = extent.fit(frustum, 0);
    assert.ok(extent.fits({ ...frustum, kx: kx * 1.0001, ky: ky * 1.0001 }, eye));
    // A little nearer, something is cut off.
    assert.ok(!extent.fits(frustum, [eye[0], eye[1], eye[2] - 0.02 * (eye[2] - target[2])]));
  }
});

test("strays of a cloud are left aside, ends of a rope are not", () => {
  const points = new Float32Array(3 * 1000);
  for (let k = 0; k < 999; ++k) points[3 * k] = k / 999;
  points[3 * 999] = 500;
  const [cloud, rope] = [new Extent(), new Extent()];
  cloud.addCloud(points, 1000, 0, true);
  rope.addCloud(points, 1000, 0, false);
  assert.ok(cloud.along(0)[1] < 2 && rope.along(0)[1] === 500);
});

test("an axis has round values of what it shows", () => {
  const time = { name: "t", unit: "s", slope: 1 / 160, offset: -1, decades: [] };
  const { label, ticks } = axisOf(time, -1, 1, 5);
  assert.equal(label, "t (s)");
  assert.deepEqual(ticks.map((tick) => tick.label), ["0", "100", "200", "300"]);
  assert.ok(Math.abs(ticks[1].at - (100 / 160 - 1)) < 1e-12);
  assert.ok(Math.abs(placeOf(time, 320) - 1) < 1e-12);
  // log(y + 1e-5) / 5 + 1.2: decades, and none of those that its offset swallows.
  const place = (y) => Math.log(y + 1e-5) / 5 + 1.2;
  const decades = Array.from({ length: 41 }, (_, k) => [10 ** (k - 20), place(10 ** (k - 20))]).flat();
  const logarithm = { name: "y", unit: "", slope: 1, offset: 0, decades };
  const texts = axisOf(logarithm, -1.1, 1.3, 5).ticks.map((tick) => tick.label);
  assert.ok(texts.includes("1") && texts.includes("0.01") && !texts.includes("1e\u22128"), texts.join());
  assert.ok(Math.abs(placeOf(logarithm, 0.03) - place(0.03)) < 1e-3);
  assert.deepEqual(axisOf({ ...logarithm, decades: [] }, 0, 1, 5).ticks.map((tick) => tick.label), ["0", "0.2", "0.4", "0.6", "0.8", "1"]);
});

test("level lines, arrows and streamlines of known fields", () => {
  const n = 9;
  const x = Float32Array.from({ length: n * n }, (_, k) => k % n);
  const line = [];
  levelLine(x, { nx: n, ny: n }, 2.5, line);
  assert.equal(line.length, 4 * (n - 1));
  for (let k = 0; k < line.length; k += 2) assert.equal(line[k], 2.5);
  const ones = new Float32Array(n * n).fill(1);
  const none = new Float32Array(n * n);
  const shafts = [];
  arrows({ nx: n, ny: n, u: ones, v: none }, 1, shafts);
  assert.equal(shafts.length, 12 * n * n);
  assert.ok(Math.abs(shafts[2] - shafts[0] - 0.9) < 1e-6);
  // Round a vortex every point stays at its distance: 5e-4 is many times the error of Runge-Kutta steps of half a cell.
  const m = 33;
  const u = Float32Array.from({ length: m * m }, (_, k) => 16 - Math.floor(k / m));
  const v = Float32Array.from({ length: m * m }, (_, k) => (k % m) - 16);
  const path = streamline({ nx: m, ny: m, u, v }, 22, 16, 0.5, 100);
  assert.equal(path.length, 200);
  for (let k = 0; k < path.length; k += 2) assert.ok(Math.abs(Math.hypot(path[k] - 16, path[k + 1] - 16) - 6) < 5e-4);
});

test("streamlines keep apart where the flow crowds, and are those of the service's pictures", () => {
  // The eddy of tests/unit/math/even_streamlines_test.cc.
  const n = 40;
  const at = (f) => Float32Array.from({ length: n * n }, (_, k) => f((k % n) - 26, Math.floor(k / n) - 20));
  const eddy = { nx: n, ny: n, u: at((_, y) => -y), v: at((x) => x * (x > 0 ? 9 : 1)) };
  const closest = (lines) => {
    let least = Infinity;
    for (const a of lines) for (const b of lines) {
      // Both halves of a line start from one seed.
      if (a[0] === b[0] && a[1] === b[1]) continue;
      for (let i = 0; i < a.length; i += 2) for (let j = 0; j < b.length; j += 2) least = Math.min(least, Math.hypot(a[i] - b[j], a[i + 1] - b[j + 1]));
    }
    return least;
  };
  const lines = evenStreamlines(eddy, 60);
  // A quarter of the seeds' spacing.
  assert.ok(closest(lines) >= (0.25 * 39) / Math.sqrt(60));
  assert.deepEqual([lines.length, lines.reduce((sum, line) => sum + line.length / 2, 0)], [19, 1056]);
  // Control: lines from the same seeds that do not look at each other.
  assert.ok(closest(Array.from({ length: 8 }, (_, k) => streamline(eddy, 2.4 + 4.9 * k, 20, 0.5, 160))) < 1);
});

test("missing samples are gaps, uneven ones are not", () => {
  const even = Array.from({ length: 60 }, (_, k) => 0.1 * k * (1 + 0.2 * Math.sin(k)));
  assert.deepEqual(gapsIn([...even].sort((a, b) => a - b)), []);
  assert.deepEqual(gapsIn([0, 0.1, 0.2, 0.3, 5, 5.1, 5.2, 5.3]), [4]);
});

test("a drift is seen beside a large value, and ticks tell themselves apart", () => {
  assert.deepEqual(relative([null, 200, 200.0002]).map((value) => value && +value.toFixed(9)), [null, 0, 1e-6]);
  const { exponent, labels } = scaleOf([418000, 418100, 418200], 100);
  assert.equal(exponent, 3);
  assert.deepEqual(labels, ["418.0", "418.1", "418.2"]);
  assert.deepEqual(scaleOf([-5.4, -5.2], 0.2).labels, ["−5.4", "−5.2"]);
  assert.equal(chooseAtFirst(["a.integrator.steps", "a.x", "a.y"]).names[0], "a.x");
});

test("the ends of a colour bar have the digits of the larger", () => {
  assert.deepEqual(endsOf(4.407e-6, 0.87741), ["0", "0.8774"]);
  assert.deepEqual(endsOf(-1234.56, 17.2), ["-1235", "17"]);
  assert.deepEqual(endsOf(1.5e-9, 3.25e-8), ["1.5e-9", "3.25e-8"]);
  assert.deepEqual(endsOf(0, 2.5), ["0", "2.5"]);
});

test("speeds fit the scene's step, up to a thousand", () => {
  assert.ok(speedsFor(5).includes(1000) && !speedsFor(5).includes(0.01));
  assert.ok(speedsFor(1e-4).includes(0.001) && !speedsFor(1e-4).includes(1000));
  assert.equal(speedAtFirst(1 / 60, 10), 1);
  // Two hundredths of a second last five seconds at least, and an hour half a minute at most.
  assert.ok(0.02 / speedAtFirst(5e-4, 0.02) >= 5);
  assert.ok(2000 / speedAtFirst(5, 2000) <= 36);
  // Five years of planets, thirty picoseconds of atoms.
  assert.ok(1.6e8 / speedAtFirst(432000, 1.6e8) <= 36 && 1.6e8 / speedAtFirst(432000, 1.6e8) > 5);
  assert.ok(3e-11 / speedAtFirst(5e-15, 3e-11) >= 5 && !speedsFor(5e-15).includes(1));
});

test("an address makes the scene again", async () => {
  const scene = { name: "ä", systems: [{ type: "ode", states: { x: 1 } }] };
  const packed = await packScene(scene);
  const read = (address) => readAddress(new URL(address, "http://here").search, new URL(address, "http://here").hash);
  const view = { eye: [1, 2, 3], target: [0, 0, 0.123456] };
  const rounded = { eye: [1, 2, 3], target: [0, 0, 0.12346] };
  const address = writeAddress({ packed, time: 1.25, ...view });
  assert.deepEqual(read(address), { packed, time: 1.25, ...rounded });
  assert.deepEqual(await unpackScene(read(address).packed), scene);
  await assert.rejects(unpackScene(packed.slice(0, -4)), "a link that was cut off");
  assert.equal(writeAddress({ gallery: "lorenz", packed, time: 0 }), "/?gallery=lorenz");
  assert.deepEqual(read(writeAddress({ gallery: "lorenz", time: 2, ...view })), { gallery: "lorenz", time: 2, ...rounded });
  // A session's address says besides how to make it; one that only watches does not, and no time.
  assert.deepEqual(read(writeAddress({ session: "a b", gallery: "lorenz", time: 2 })), { session: "a b", gallery: "lorenz", time: 2 });
  assert.deepEqual(read(writeAddress({ session: "a", packed, time: 2 })), { session: "a", packed, time: 2 });
  assert.deepEqual(read(writeAddress({ watch: "a", gallery: "lorenz", time: 2, ...view })), { watch: "a", ...rounded });
  assert.equal(writeAddress({ time: 3, ...view }), "/");
  assert.deepEqual(read("/#"), {});
});

test("a scene's chapter is that of its systems, whatever its tags say", () => {
  assert.equal(chapterOf(["rigid2d"]), "Rigid bodies in the plane");
  assert.equal(chapterOf(["mass_spring", "rigid3d"]), "Things that meet");
  assert.equal(chapterOf(["mass_spring", "xpbd"]), chapterOf(["xpbd"]));
  assert.equal(chapterOf(["skeleton", "mass_spring"]), "Animation");
  assert.equal(chapterOf(["something"]), "More");
  const folder = new URL("../../scenes/", import.meta.url);
  const chapters = new Map(readdirSync(folder).filter((name) => name.endsWith(".json")).map((name) => [name, chapterOf(JSON.parse(readFileSync(new URL(name, folder), "utf8")).systems.map(({ type }) => type))]));
  assert.deepEqual([...chapters].filter(([, chapter]) => chapter === "More"), []);
  assert.equal(chapters.get("car_3d.json"), "Rigid bodies");
});

test("scenes are found by words, not by letters within them", () => {
  const entry = { name: "flag", title: "A flag", teaches: "it flutters because of the wind on cloth", tags: ["cloth"], systems: ["mass_spring"] };
  for (const query of ["cloth WIND", "", "flut", "mass spring", "flag,"]) assert.ok(matches(entry, query), query);
  for (const query of ["use", "cause", "flag rigid", "win", "lag"]) assert.ok(!matches(entry, query), query);
  assert.ok(matches({ name: "cars", title: "", tags: [] }, "car"));
});

test("a field is coloured by what it means", () => {
  const amount = { width: 1, scale: "", kinds: [] };
  const deviation = { width: 1, scale: "deviation", kinds: [] };
  const material = { width: 1, scale: "", kinds: ["fluid", "jelly", "sand"] };
  assert.equal(schemeOf({ color_by: "speed" }, "speed", amount).map, "viridis");
  assert.equal(schemeOf({ color_by: "vorticity" }, "vorticity", deviation).map, "balance");
  assert.equal(schemeOf({ color_by: "vorticity", color_map: "ember" }, "vorticity", deviation).map, "ember");
  assert.deepEqual(balanced([-1, 3]), [-3, 3]);
  const kinds = schemeOf({ color_by: "material" }, "material", material);
  assert.deepEqual([0, 1, 2, 7, NaN].map((value) => kindAt(kinds, value)), [0, 1, 2, 2, 0]);
  const halves = schemeOf({ color_by: "id", names: ["first", "second"], range: [0, 100] }, "id", amount);
  assert.deepEqual([0, 49, 51, 100].map((value) => kindAt(halves, value)), [0, 0, 1, 1]);
  // A legend and names are only those of the field that they speak of.
  assert.deepEqual(schemeOf({ color_by: "id", names: ["first", "second"] }, "speed", amount).kinds, []);
});

test("times are told in the unit of the run", () => {
  assert.equal(timeText(1.25, 8), "1.250 s");
  assert.equal(timeText(31557600, 157680000), "1.00 years");
  assert.equal(timeText(1.2e-11, 3e-11), "12.00 ps");
  assert.equal(timeText(0, 2e-12), "0.00 ps");
  assert.equal(timeText(0), "0.000 s");
  assert.deepEqual(tickTexts([0, 0.5, 1]), ["0 s", "0.5 s", "1 s"]);
  assert.deepEqual(tickTexts([0, 1e7, 2e7]), ["0 days", "116 days", "231 days"]);
  assert.deepEqual(tickTexts([]), []);
});

test("a scene says whether gravity pulls and how long it lasts", () => {
  assert.deepEqual(infoOf({ gravity: [0, 0, 0], time: { dt: 0.01, duration: 3 }, systems: [] }), { pulled: false, gravity: [0, 0, 0], observables: [], probes: [], duration: 3, dt: 0.01 });
  assert.ok(infoOf({ systems: [] }).pulled && infoOf(undefined).pulled);
});

test("the viewer has the colours of the service's pictures", () => {
  const header = readFileSync(new URL("../../engine/sinks/picture/color_stops.h", import.meta.url), "utf8");
  for (const [name, hex] of Object.entries(colorStops)) {
    const table = new RegExp(`k${name}\\[\\] = \\{([^}]*)\\}`, "i").exec(header)[1].split(",").map((one) => JSON.parse(one.trim().replace(/^0x(.*)$/, (_, digits) => String(Number.parseInt(digits, 16)))));
    assert.deepEqual(hex, table, name);
  }
});

test("a ball of particles has the smooth surface of a ball, closed and outward", () => {
  const places = [];
  const [spacing, radius] = [0.1, 0.8];
  for (let i = -8; i < 8; ++i) for (let j = -8; j < 8; ++j) for (let k = -8; k < 8; ++k) {
    const p = [i, j, k].map((n) => (n + 0.5) * spacing);
    if (Math.hypot(...p) < radius) places.push(...p);
  }
  places.push(NaN, 0, 0);
  const count = places.length / 3;
  const { positions, triangles, values } = particleSurface(Float32Array.from(places), count, Float32Array.from({ length: count }, () => 3), spacing, 0.75 * spacing);
  const at = (k) => positions.subarray(3 * k, 3 * k + 3);
  let volume = 0;
  const edges = new Map();
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [at(triangles[t]), at(triangles[t + 1]), at(triangles[t + 2])];
    volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6;
    for (let e = 0; e < 3; ++e) {
      const [p, q] = [triangles[t + e], triangles[t + ((e + 1) % 3)]];
      edges.set(`${p} ${q}`, (edges.get(`${p} ${q}`) ?? 0) + 1);
    }
  }
  // Every edge once in each direction.
  for (const [edge, times] of edges) assert.ok(times === 1 && edges.get(edge.split(" ").reverse().join(" ")) === 1);
  // A tenth of a spacing all round is 4 % of the volume that the particles have.
  const own = (count - 1) * spacing ** 3;
  assert.ok(Math.abs(volume - own) < 0.05 * own, `${volume} ${own}`);
  for (let k = 0; k < positions.length / 3; ++k) assert.ok(Math.abs(Math.hypot(...at(k)) - radius) < 0.7 * spacing);
  for (const value of values) assert.ok(Math.abs(value - 3) < 1e-3);
  // Control: particles with half the spacing that they are said to have are twice as many for the same surface.
  const none = particleSurface(new Float32Array(0), 0, undefined, spacing, spacing);
  assert.equal(none.triangles.length, 0);
});

test("a colour bar has the scene's legend or the field's name, and a unit", () => {
  const scene = (color_by, legend) => ({ color_by, legend });
  assert.equal(scaleLabel(scene("scalar", "smoke"), "scalar", "1"), "smoke");
  assert.equal(scaleLabel(scene("pressure", "overpressure"), "pressure", "Pa"), "overpressure (Pa)");
  assert.equal(scaleLabel(scene("speed", "speed of the spray"), "velocity", "m/s", true), "velocity, length (m/s)");
  assert.equal(scaleLabel({}, "speed", "m/s"), "speed (m/s)");
});

test("a grid is shown by the field that its scene names, from the first frame on", () => {
  const part = (id, lattice, ...fields) => ({ id, system: id, elements: "", lattice, fields: fields.map((name) => ({ name, unit: "", meaning: "value" })) });
  const hello = { parts: [part("flow", {}, "velocity", "vorticity"), part("unseen", {}, "pressure", "vorticity")] };
  const asked = (colorBy, topology) => fieldsOf({ colorBy, bySpeed: true }, hello, topology);
  assert.deepEqual(asked("vorticity", undefined), ["vorticity"]);
  assert.deepEqual(asked("", { systems: [{ system: "flow", visuals: [], pointRadius: 0, color: [] }] }), ["velocity"]);
});

const bytesOf = (array) => new Uint8Array(array.buffer);

test("triangles show the values of their elements", () => {
  const triangles = bytesOf(Uint32Array.from([0, 1, 2, 2, 1, 3, 3, 4, 5]));
  const field = { system: "s.elements", field: "stress", count: 2, width: 1, data: Float32Array.from([7, 9]) };
  const shown = (...elements) => [...triangleValues({ triangles, triangleElements: bytesOf(Uint32Array.from(elements)) }, field)];
  assert.deepEqual(shown(1, 1, 0), [9, 9, 7]);
  assert.deepEqual(shown(1, 5, 0), [9, NaN, 7], "control: there is no such element");
  assert.deepEqual(shown(), [7, 9, NaN], "without elements, the value of the triangle's own number");
  assert.deepEqual([...triangleValues({ triangles: triangles.subarray(0, 12), triangleElements: new Uint8Array(0) }, { ...field, count: 1, width: 3, data: Float32Array.from([2, 3, 6]) })], [7], "the length of a vector");
});

test("marks of joints show the values of their rows in their part", () => {
  const joints = new Uint8Array(3 * 36);
  const values = new Map([[4, [10, 30]]]);
  const marks = (...rows) => ({ joints, jointRows: bytesOf(Uint32Array.from(rows)) });
  assert.deepEqual([...jointValues(marks(4, 1, 4, 0, 2, 0), values)], [30, 10, NaN]);
  assert.deepEqual([...jointValues(marks(), values)], [NaN, NaN, NaN], "a service that sends no rows");
  const part = (elements) => ({ elements });
  const parts = new Map([["a", part("")], ["b", part("")], ["c", part("")], ["d", part("")], ["d.joints", part("joints")]]);
  const found = new JointValues();
  const force = { system: "d.joints", field: "force", count: 2, width: 1, data: Float32Array.from([10, 30]) };
  found.take([force], parts, "force");
  assert.deepEqual(found.ownRange, [10, 30]);
  const colors = found.colors(marks(4, 1, 4, 0, 0, 4294967295), "viridis", [10, 30]);
  assert.ok(colors[0].r > 0.9 && colors[0].b < 0.1 && colors[1].b > 2 * colors[1].r && colors[2] === undefined, JSON.stringify(colors));
  found.take([force], parts, "torque");
  assert.equal(found.ownRange, undefined);
});

test("values of triangles and joints are requested where the scene names them", () => {
  const field = (name, meaning = "value") => ({ name, unit: "", meaning });
  const part = (id, system, elements, ...fields) => ({ id, system, elements, fields });
  const hello = { parts: [part("s", "s", "", field("x", "position")), part("s.elements", "s", "triangles", field("stress")), part("s.bins", "s", "", field("density"))] };
  const topology = { systems: [{ system: "s", visuals: [], pointRadius: 0, triangles: new Uint8Array(12) }] };
  const asked = (colorBy, bySpeed = true) => fieldsOf({ colorBy, bySpeed }, hello, topology);
  assert.deepEqual(asked("stress"), ["x", "stress"]);
  assert.deepEqual(asked("stress", false), ["x"]);
  assert.deepEqual(asked("density"), ["x"]);
});

test("up is the axis against gravity, or the one that a scene's own camera names", () => {
  assert.deepEqual(upOf([0, -9.81, 0]), [0, 1, 0]);
  assert.deepEqual(upOf([0, 0, -9.81]), [0, 0, 1]);
  // A camera that says y says its default.
  assert.deepEqual(upOf([0, 0, -9.81], [0, 1, 0]), [0, 0, 1]);
  assert.deepEqual(upOf([0, 0, 0], [0, 0, 1]), [0, 0, 1]);
  // Along no axis, upwards, or none at all: y.
  for (const gravity of [[3, -9, 3], [5, -8, 0], [0, 9.81, 0], [0, 0, 0], undefined]) assert.deepEqual(upOf(gravity), [0, 1, 0]);
});

test("a plot begins with what the scene lists, unless that is its energy", () => {
  const names = ["energy.kinetic", "energy.total", "flow.drag", "flow.lift", "flow.iterations"];
  const units = new Map([["flow.drag", "N"], ["flow.lift", "N"], ["flow.iterations", "1"]]);
  assert.deepEqual(chooseAtFirst(names, ["flow.lift", "flow.drag", "flow.iterations"], units).names, ["flow.lift", "flow.drag"]);
  assert.equal(chooseAtFirst(names, ["flow.lift", "energy.total"], units).title, "Energy");
  assert.equal(chooseAtFirst(names, ["unknown"], units).title, "Energy");
  assert.equal(chooseAtFirst(names).title, "Energy");
});

test("a request for the past that comes too soon is made later, once", async () => {
  let asked = 0;
  const taken = [];
  const past = new Past(async () => ++asked, 20);
  const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
  for (const k of [1, 2, 3]) past.request("s", (history) => taken.push([k, history]));
  await wait(5);
  assert.deepEqual(taken, [[1, 1]]);
  await wait(100);
  assert.deepEqual(taken, [[1, 1], [3, 2]]);
  // A request that failed does not end them.
  const failing = new Past(() => Promise.reject(new Error("gone")), 5);
  failing.request("s", () => assert.fail("there is nothing to take"));
  failing.request("s", () => assert.fail("there is nothing to take"));
  await wait(50);
});

test("a request for the past of a session that the page has left meanwhile is not made", async () => {
  const asked = [];
  const past = new Past(async (id) => asked.push(id), 5);
  for (let k = 0; k < 2; ++k) past.request("left", () => undefined);
  past.forget();
  await new Promise((resolve) => setTimeout(resolve, 40));
  assert.deepEqual(asked, ["left"]);
});
