// The colours of a scene in the viewer are those of its pictures: without a field a system has its own colour, with one the map's,
// over the range of the data; what is black or as small as an atom can still be seen. Runs against the executable in
// TRUESTEP_BINARY.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import { ask, open, pixels, settled, until } from "./pixels.mjs";
import { bad, browser, page, url } from "./served.mjs";

const kFree = { x: 60, y: 70, width: 880, height: 600 }; // no panel is there
const kSaturated = 0.25; // of a pixel: (max - min) / max of its channels; ground and background have less
const kSameHue = 12; // degrees: light and shade of the two renderers differ, colours do not

let picture;

before(async () => {
  picture = await browser.newPage({ viewport: { width: 1280, height: 800 } });
});

/** Hue in degrees of all coloured pixels together, and how many there are. */
async function hueOf(where, clip = kFree) {
  const shot = await pixels(where, clip);
  const found = shot.where((r, g, b) => {
    const most = Math.max(r, g, b);
    return most > 40 && most - Math.min(r, g, b) > kSaturated * most;
  });
  const sum = [0, 0, 0];
  for (const [x, y] of found) shot.at(x, y).forEach((c, k) => (sum[k] += c));
  const [r, g, b] = sum;
  return { hue: (180 / Math.PI) * Math.atan2(Math.sqrt(3) * (g - b), 2 * r - g - b), count: found.length };
}

async function drawn(id) {
  await picture.goto(`${url}/v1/sessions/${id}/picture.png?width=1280&height=800&theme=dark`);
  return hueOf(picture, { x: 60, y: 70, width: 1160, height: 560 });
}

const apart = (a, b) => Math.abs(((a - b + 540) % 360) - 180);

const still = { time: { dt: 0.005 }, gravity: [0, -9.81, 0] };
const water = { type: "sph", id: "water", low: [0, 0, 0], high: [1, 1, 0.5], spacing: 0.05, bodies: [{ center: [0.25, 0.3, 0.25], half_extents: [0.25, 0.3, 0.25] }] };

test("water without a field has one and the same colour in viewer and picture; the switch shows speed", async () => {
  const id = await open(page, url, { ...still, systems: [water] });
  await ask(url, `/v1/sessions/${id}/step`, { steps: 40 });
  await until(page, async () => (await page.textContent("#read-step")) === "40", "40 steps");
  assert.equal(await page.getAttribute("#show-speed", "aria-pressed"), "false");
  const [own, sent] = [await hueOf(page), await drawn(id)];
  assert.ok(Math.min(own.count, sent.count) > 2000, `${own.count} and ${sent.count} coloured pixels`);
  assert.ok(apart(own.hue, sent.hue) < kSameHue, `${own.hue} in the viewer, ${sent.hue} in the picture`);
  await page.keyboard.press("m");
  assert.ok(await page.locator("#scale").isHidden(), "no legend explains a colour of its own");
  await page.keyboard.press("c");
  await until(page, () => page.locator("#scale").isVisible(), "a legend");
  assert.match(await page.textContent("#scale"), /speed \(m\/s\)/);
  // The control: colours of values are not all blue, as the first ones were.
  const green = async () => (await pixels(page, kFree)).where((r, g, b) => g > 70 && g > 1.15 * b && g > 1.15 * r).length;
  const many = await green();
  await page.keyboard.press("c");
  await until(page, () => page.locator("#scale").isHidden(), "no legend");
  const none = await green();
  assert.ok(many > 200 && none < 20, `${many} green pixels by speed, ${none} without`);
});

test("the range of the colours goes from the lowest to the highest value, as in pictures", async () => {
  const id = await open(page, url, { ...still, viewer: { color_by: "density" }, systems: [water] });
  await ask(url, `/v1/sessions/${id}/step`, { steps: 40 });
  await until(page, async () => (await page.textContent("#read-step")) === "40", "40 steps");
  const frame = await (await fetch(`${url}/v1/sessions/${id}/frames/latest?fields=density`, { headers: { accept: "application/json" } })).json();
  const values = JSON.stringify(frame).match(/"density".*?\[([-\d.,e+\s]+)\]/s)[1].split(",").map(Number);
  const least = Math.min(...values);
  assert.ok(least > 300, `${least} kg/m^3`);
  const low = await page.$eval("#scale", (bar) => Number(bar.children[2].textContent.replaceAll(",", "")));
  assert.ok(low > 300, `the legend begins at ${low}, no water is lighter than ${least}`);
});

test("a body without the field that colours the rest keeps its colour", async () => {
  const body = { type: "rigid3d", id: "body", bodies: [{ type: "sphere", radius: 0.15, position: [0.25, 0.9, 0.25], color: [0.9, 0.1, 0.1], motion: "fixed" }] };
  await open(page, url, { ...still, viewer: { color_by: "density", labels: false }, systems: [water, body] });
  const red = (await pixels(page, kFree)).where((r, g, b) => r > 70 && r > 3 * g && r > 3 * b);
  assert.ok(red.length > 500, `${red.length} red pixels`);
});

test("the low end of a colour map has the colour of its legend", async () => {
  const id = await open(page, url, { ...still, gravity: [0, 0, 0], viewer: { color_by: "speed", range: [0, 10] }, systems: [water] });
  const [own, sent] = [await hueOf(page), await drawn(id)];
  assert.ok(apart(own.hue, sent.hue) < kSameHue, `${own.hue} in the viewer, ${sent.hue} in the picture`);
  // On dark paper viridis begins with rgb(125, 91, 190): more blue than red, and least green.
  const shot = await pixels(page, kFree);
  const purple = shot.where((r, g, b) => b > 50 && b > 1.2 * r && r > 1.1 * g);
  assert.ok(purple.length > 0.6 * own.count, `${purple.length} of ${own.count} pixels are purple`);
});

test("nothing of a deviation is the colour of the paper, in a paused session too", async () => {
  const eddies = { type: "grid_fluid", id: "flow", cells: [32, 32], size: [1, 1], side: { kind: "periodic" }, initial: ["sin(2*pi*y)", "sin(2*pi*x)"] };
  await open(page, url, { time: { dt: 0.001 }, gravity: [0, 0, 0], viewer: { color_by: "vorticity", labels: false }, systems: [eddies] });
  await settled(page);
  const shares = async () => {
    const shot = await pixels(page, { x: 400, y: 200, width: 400, height: 300 });
    const all = shot.where(() => true).length;
    return { dark: shot.where((r, g, b) => r + g + b < 260).length / all, pale: shot.where((r, g, b) => r + g + b > 600).length / all };
  };
  const bar = () => page.$eval("#scale > i", (ramp) => ramp.style.background);
  const [night, nightBar] = [await shares(), await bar()];
  await page.keyboard.press("l");
  await settled(page);
  const [day, dayBar] = [await shares(), await bar()];
  await page.keyboard.press("l");
  assert.ok(night.dark > 0.15 && night.pale < 0.05, JSON.stringify(night));
  assert.ok(day.pale > 0.15 && day.dark < 0.1, JSON.stringify(day));
  assert.notEqual(nightBar, dayBar);
});

test("kinds have names beside their colours instead of a bar", async () => {
  const box = (x, material) => ({ shape: "box", center: [x, 0.5, 0], half_extents: [0.2, 0.2, 1], material });
  const both = { type: "mpm", id: "both", dimension: 2, low: [0, 0, 0], high: [1, 1, 0], cell: 0.05, bodies: [box(0.25, "fluid"), box(0.75, "sand")] };
  await open(page, url, { ...still, viewer: { color_by: "material" }, systems: [both] });
  await until(page, async () => (await page.$$("#scale em > span")).length === 2, "two names");
  assert.deepEqual(await page.$$eval("#scale em > span", (names) => names.map((name) => name.textContent)), ["fluid", "sand"]);
  const barHidden = () => page.$eval("#scale > i", (bar) => bar.hidden);
  assert.ok(await barHidden());
  const shot = await pixels(page, kFree);
  const [fluid, sand] = [shot.where((r, g, b) => b > 90 && b > 1.5 * r), shot.where((r, g, b) => r > 90 && r > 1.3 * b)];
  assert.ok(fluid.length > 2000 && sand.length > 2000, `${fluid.length} pixels of fluid, ${sand.length} of sand`);
  // Control: amounts have a bar.
  await open(page, url, { ...still, viewer: { color_by: "density" }, systems: [both] });
  await until(page, async () => /density/.test(await page.textContent("#scale")), "a bar");
  assert.ok(!(await barHidden()));
  assert.equal((await page.$$("#scale em > span")).length, 0);
});

test("black balls are seen on a dark ground", async () => {
  const balls = { type: "particles", id: "balls", positions: [[-0.5, 0.5, 0], [0.5, 0.5, 0]], radius: 0.3, draw_radius: 0.3, color: [0, 0, 0] };
  await open(page, url, { ...still, gravity: [0, 0, 0], systems: [balls] });
  const shot = await pixels(page, kFree);
  const background = shot.at(70, 80);
  const seen = shot.where((r, g, b) => r + g + b > background[0] + background[1] + background[2] + 60);
  // Lit as if they were black, only highlights and rims would: a seventh of this.
  assert.ok(seen.length > 100_000, `${seen.length} pixels stand out`);
});

test("a scene as small as atoms is seen, and the wheel changes its picture", async () => {
  const argon = { type: "molecular", id: "argon", kinds: [{ name: "Ar", sigma: 3.4e-10, epsilon: 1.6568e-21 }], lattice: { cells: [3, 3, 3], number_density: 2.0714e28 }, cutoff: 7e-10, skin: 1e-10, draw_radius: 1.2e-10, color: [0.15, 0.45, 0.75] };
  await open(page, url, { time: { dt: 1e-14 }, gravity: [0, 0, 0], systems: [argon] });
  const { count } = await hueOf(page);
  assert.ok(count > 20000, `${count} pixels of argon`);
  await page.mouse.move(500, 370);
  for (let k = 0; k < 5; ++k) await page.mouse.wheel(0, 240);
  await until(page, async () => (await hueOf(page)).count < 0.7 * count, "it is farther away");
});

test("the switch of colours is there where something has the field", async () => {
  const curve = { type: "ode", id: "curve", states: { x: 1, y: 0 }, equations: { x: "-y", y: "x" }, plot: ["x", "y"] };
  await open(page, url, { time: { dt: 0.01 }, systems: [curve] });
  assert.ok(await page.locator("#show-speed").isHidden(), "a curve has no speed");
  await open(page, url, { ...still, systems: [water] });
  assert.ok(await page.locator("#show-speed").isVisible(), "control: water has");
});

/** How many pixels have the colours of the map's ends, violet and yellow. */
async function ends() {
  const shot = await pixels(page, { x: 60, y: 70, width: 1160, height: 600 });
  return [shot.where((r, g, b) => b > g + 40 && r > g + 20).length, shot.where((r, g, b) => r > 2.5 * b && g > 2.5 * b && r > 100).length];
}

test("triangles have the colours of their elements", async () => {
  // Of two squares one is stretched by half: J = 1 and 1.5, the ends of the map, violet and yellow.
  const squares = (viewer) => ({
    time: { dt: 0.1 }, gravity: [0, 0, 0], viewer: { labels: false, ...viewer },
    systems: [{
      type: "fem", id: "s", motion: "quasi_static", plane: "strain", element: "quad4",
      mesh: { cells: [0, 1, 2, 3, 4, 5, 6, 7], vertices: [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [3, 0, 0], [3, 1, 0], [2, 1, 0]] },
      sets: [{ name: "still", high: [1.5, 2, 1] }, { name: "pulled", low: [1.5, -1, -1] }],
      holds: [{ on: "still" }, { on: "pulled", x: "X/2-1", y: "0" }],
    }],
  });
  const shown = async (viewer) => {
    const id = await open(page, url, squares(viewer));
    await ask(url, `/v1/sessions/${id}/step`, { steps: 1 });
    await until(page, async () => (await page.textContent("#read-step")) === "1", "a step");
  };
  await shown({ color_by: "jacobian" });
  await until(page, async () => Math.min(...(await ends())) > 3000, "a violet square and a yellow one");
  assert.match(await page.textContent("#scale"), /jacobian/);
  await shown({});
  const without = await ends();
  assert.ok(Math.max(...without) < 50, `control: ${without}`);
});

test("joints have the colours of their forces", async () => {
  const hanging = (viewer) => ({
    time: { dt: 0.01 }, gravity: [0, -10, 0], viewer: { labels: false, ...viewer },
    systems: [{
      type: "rigid3d", id: "r", sleeping: false,
      bodies: [{ type: "sphere", radius: 0.2, mass: 1, position: [0, 0, 0] }, { type: "sphere", radius: 0.2, mass: 3, position: [2, 0, 0] }],
      joints: [{ type: "ball", a: -1, b: 0, anchor: [0, 0.5, 0] }, { type: "ball", a: -1, b: 1, anchor: [2, 0.5, 0] }],
    }],
  });
  const shown = async (viewer) => {
    const id = await open(page, url, hanging(viewer));
    await ask(url, `/v1/sessions/${id}/step`, { steps: 20 });
    await until(page, async () => (await page.textContent("#read-step")) === "20", "20 steps");
  };
  await shown({ color_by: "force", range: [10, 30] });
  await until(page, async () => Math.min(...(await ends())) > 20, "a violet mark and a yellow one");
  assert.match(await page.textContent("#scale"), /force \(N\)/);
  await shown({});
  const without = await ends();
  assert.ok(Math.max(...without) < 5, `control: ${without}`);
});

test("nothing complained", () => assert.deepEqual(bad, []));
