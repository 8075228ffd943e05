// Pixels of grids in the viewer at places where the field is known: slices, volumes, level lines, arrows, streamlines,
// height fields and curves have the colours and places of their values, as in the service's pictures
// (tests/unit/pictures/grid_pixels_test.cc). Runs against the executable in TRUESTEP_BINARY.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import path from "node:path";
import { before, test } from "node:test";
import { web } from "./chromium.mjs";
import { open, pixels, settled } from "./pixels.mjs";
import { bad, page, url } from "./served.mjs";

let view; // pixels: {metre, middle: [x, y]} of the plane of the unit square

const kStops = readFileSync(path.join(web, "src/render/fields/color_stops.ts"), "utf8")
  .match(/viridisHex = \[([^\]]*)\]/)[1].split(",").map(Number);
/** The map's colour of t in [0, 1], bytes. */
function mapped(t) {
  const x = Math.min(Math.max(t, 0), 1) * (kStops.length - 1);
  const i = Math.min(Math.floor(x), kStops.length - 2);
  return [16, 8, 0].map((shift) => {
    const [a, b] = [kStops[i], kStops[i + 1]].map((hex) => (hex >> shift) & 255);
    return a + (x - i) * (b - a);
  });
}
const apart = (a, b) => Math.max(...a.map((v, c) => Math.abs(v - b[c])));
const isInk = (c) => Math.max(...c) < 60; // nearly black, which no colour of the map is
const hue = ([r, g, b]) => (180 / Math.PI) * Math.atan2(Math.sqrt(3) * (g - b), 2 * r - g - b);
const turned = (a, b) => Math.abs(((a - b + 540) % 360) - 180);
const kSame = 8; // bytes: 256 colours, their straight line across a cell, and rounding

// From so far away that a metre behind shrinks by a thirtieth.
const kFar = 30;
const fov = 2 * Math.atan(1 / kFar); // rad, of two metres
const front = { eye: [0.5, 0.5, kFar], target: [0.5, 0.5, 0], up: [0, 1, 0], fov };
const clip = { x: 0, y: 56, width: 1280, height: 640 };

const sceneOf = (system, viewer, camera) => ({
  time: { dt: 1e-6 }, gravity: [0, 0, 0], viewer: { labels: false, camera, ...viewer }, systems: [{ id: "g", ...system }],
});

/** Shows a scene; {at(right, up), ink(right, up)}: the pixel there, in metres, and the darkest within two pixels. */
async function shown(system, viewer, camera = front) {
  await open(page, url, sceneOf(system, viewer, camera));
  await settled(page);
  const shot = await pixels(page, clip);
  const at = (right, up) => shot.at(view.middle[0] + (right - 0.5) * view.metre, view.middle[1] - (up - 0.5) * view.metre);
  const ink = (right, up) => {
    let darkest = [255, 255, 255];
    for (let dx = -2; dx <= 2; ++dx) {
      for (let dy = -2; dy <= 2; ++dy) {
        const c = at(right + dx / view.metre, up + dy / view.metre);
        if (c[0] + c[1] + c[2] < darkest[0] + darkest[1] + darkest[2]) darkest = c;
      }
    }
    return darkest;
  };
  return { at, ink };
}
const places = [0.1, 0.3, 0.5, 0.7, 0.9];
/** Largest distance of a channel from the colours of `value` at 25 places. */
const worst = ({ at }, value) => Math.max(...places.flatMap((x) => places.map((y) => apart(at(x, y), mapped(value(x, y))))));

const plate = { type: "heat", cells: [60, 60], initial: "(x^2 + y)/2" };
const value = (x, y) => 0.5 * (x * x + y);

before(async () => {
  // On a light background ink stands out. How the view fits its camera's picture into the window is seen from a plate.
  await open(page, url, sceneOf({ type: "heat", cells: [60, 60], initial: "1" }, { range: [0, 1] }, front));
  await page.keyboard.press("l");
  await settled(page);
  const yellow = (await pixels(page, clip)).where((r, g, b) => r > 200 && g > 180 && b < 120);
  const [low, high] = [Math.min, Math.max].map((most) => [0, 1].map((c) => yellow.reduce((v, at) => most(v, at[c]), yellow[0][c])));
  view = { metre: high[0] + 1 - low[0], middle: [0, 1].map((c) => (low[c] + high[c]) / 2) };
  assert.ok(Math.abs(high[1] + 1 - low[1] - view.metre) <= 1, "a square");
});

test("a slice has the colours of its values", async () => {
  assert.ok(worst(await shown(plate, { range: [0, 1] }), value) < kSame, "those of its values");
  assert.ok(worst(await shown(plate, { range: [-1, 1] }), (x, y) => 0.5 * (value(x, y) + 1)) < kSame);
  assert.ok(worst(await shown(plate, { range: [0, 2] }), value) > 5 * kSame, "control");
});

test("a slice of a volume is that of its layer", async () => {
  const block = { type: "heat", cells: [16, 16, 16], initial: "z*(x + y)/2" };
  const layer = (at) => shown(block, { range: [0, 1], slice: { axis: "z", at } });
  const there = (x, y) => 0.75 * 0.5 * (x + y);
  assert.ok(worst(await layer(0.75), there) < 1.5 * kSame, "nearer by 0.75 m of thirty");
  assert.ok(worst(await layer(0.25), there) > 5 * kSame, "control");
});

test("a volume is seen through its slices, more where values are higher", async () => {
  const block = { type: "heat", cells: [16, 16, 4], initial: "x" };
  const picture = await shown(block, { range: [0, 1] });
  const other = await shown(block, { range: [0, 2] });
  let control = 0;
  for (const x of places) {
    const behind = picture.at(-0.2, 0.4);
    const left = (1 - (0.03 + 0.47 * x)) ** 5; // of the background, behind five slices
    const want = mapped(x).map((c, k) => c * (1 - left) + behind[k] * left);
    assert.ok(apart(picture.at(x, 0.4), want) < 3 * kSame, `${x}: ${picture.at(x, 0.4)}, not ${want}`);
    control = Math.max(control, apart(other.at(x, 0.4), want));
  }
  assert.ok(control > 6 * kSame, `control: ${control}`);
});

test("level lines are where the levels are", async () => {
  const lined = (contours) => shown({ type: "heat", cells: [40, 40], initial: "x" }, { range: [0, 1], contours });
  const three = await lined(3);
  const one = await lined(1);
  for (const y of [0.15, 0.5, 0.85]) {
    for (const x of [0.25, 0.5, 0.75]) {
      assert.ok(isInk(three.ink(x, y)), `${x}`);
      assert.equal(isInk(one.ink(x, y)), x === 0.5, `control: ${x}`);
    }
    for (const x of [0.125, 0.375, 0.625, 0.875]) assert.ok(apart(three.at(x, y), mapped(x)) < kSame, `${x}`);
  }
});

const flow = (initial, sides = {}) => ({ type: "grid_fluid", cells: [10, 10], side: { kind: "slip" }, sides, initial });

test("arrows point along the velocity", async () => {
  const picture = await shown(flow(["-sin(pi*x)*cos(pi*y)", "cos(pi*x)*sin(pi*y)"]), { color_by: "velocity", range: [0, 2] });
  let seen = 0;
  for (let j = 0; j < 10; ++j) {
    for (let i = 0; i < 10; ++i) {
      const [x, y] = [(i + 0.5) / 10, (j + 0.5) / 10];
      const v = [-Math.sin(Math.PI * x) * Math.cos(Math.PI * y), Math.cos(Math.PI * x) * Math.sin(Math.PI * y)];
      const speed = Math.hypot(...v);
      const length = (0.9 * 0.1 * speed) / 2;
      if (length * view.metre < 12) continue;
      ++seen;
      const [dx, dy] = v.map((c) => (0.4 * length * c) / speed);
      assert.ok(isInk(picture.ink(x + dx, y + dy)), `an arrow from ${x}, ${y}`);
      assert.ok(!isInk(picture.ink(x - dx, y - dy)), `control: none behind ${x}, ${y}`);
    }
  }
  assert.ok(seen > 25, `${seen} arrows`);
});

test("streamlines follow the velocity", async () => {
  const up = flow(["0", "1"], { y_min: { kind: "periodic" } });
  const dark = async (viewer) => {
    const picture = await shown(up, { color_by: "velocity", range: [0, 2], ...viewer });
    const through = [];
    for (let x = 0.08; x < 0.92; x += 1 / view.metre) {
      let count = 0;
      for (let k = 0; k < 80; ++k) count += isInk(picture.at(x, 0.1 + 0.01 * k));
      if (count > 70) through.push(x);
    }
    return through;
  };
  const lines = await dark({ streamlines: 5 });
  const apartFromNext = lines.filter((x, k) => k === 0 || x - lines[k - 1] > 0.02).length;
  assert.ok(apartFromNext >= 2 && apartFromNext <= 5, `${apartFromNext} lines from bottom to top`);
  assert.ok(lines.length < 6 * apartFromNext, "thin ones");
  assert.deepEqual(await dark({}), [], "control: arrows");
});

test("a grid of cells fills its box", async () => {
  // The outermost of ten centres are 0.05 m inside; beyond them the colour is theirs.
  const picture = await shown(flow(["0", "2*x"], { y_min: { kind: "periodic" } }), { color_by: "velocity", range: [0, 2], contours: 3 });
  for (const y of [0.015, 0.31, 0.985]) {
    assert.ok(apart(picture.at(0.015, y), mapped(0.05)) < kSame, `left, ${y}: ${picture.at(0.015, y)}`);
    assert.ok(apart(picture.at(0.985, y), mapped(0.95)) < kSame, `right, ${y}: ${picture.at(0.985, y)}`);
    assert.ok(isInk(picture.ink(0.5, y)), `a level line up to the edge, ${y}`);
    assert.ok(!isInk(picture.ink(0.6, y)), `control: none at another value, ${y}`);
  }
  const behind = picture.at(-0.1, 0.3);
  for (const [x, y] of [[-0.015, 0.3], [1.015, 0.3]]) assert.ok(apart(picture.at(x, y), behind) < kSame, `nothing outside: ${x}, ${y}`);
});

test("a height field rises by its values", async () => {
  const side = { eye: [0.5, -kFar, 0.5], target: [0.5, 0.5, 0.5], up: [0, 0, 1], fov };
  const sheet = { type: "heat", cells: [40, 40], initial: "x*y" };
  const picture = await shown(sheet, { range: [0, 1], height: 1 }, side);
  const lower = await shown(sheet, { range: [0, 1], height: 0.5 }, side);
  for (const x of [0.3, 0.5, 0.7, 0.9]) {
    for (const share of [0.15, 0.5, 0.9]) {
      const there = picture.at(x, share * x);
      assert.ok(turned(hue(there), hue(mapped(share * x))) < 15, `${x}, ${share}: ${there}`);
    }
    assert.ok(apart(picture.at(x, x + 0.05), lower.at(x, x + 0.05)) < 8, "nothing above it");
    assert.ok(apart(picture.at(x, 0.9 * x), lower.at(x, 0.9 * x)) > 20, "control: half as high");
  }
});

test("a curve runs through its values", async () => {
  const picture = await shown({ type: "heat", cells: [64], initial: "sin(pi*x)" }, { range: [0, 1], height: 0.5 });
  for (const x of [0.1, 0.3, 0.7, 0.9]) { // beside the lines of the axes
    const y = Math.sin(Math.PI * x);
    assert.ok(turned(hue(picture.at(x, 0.5 * y)), hue(mapped(y))) < 15, `${x}: ${picture.at(x, 0.5 * y)}`);
    assert.ok(apart(picture.at(x, 0.5 * y - 0.04), picture.at(x, 0.5 * y - 0.05)) < 8, `control: nothing below ${x}`);
  }
});

test("nothing was written to the console as an error", () => assert.deepEqual(bad, []));
