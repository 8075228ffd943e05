// What a person sees of a scene, read back from the pixels: shadows, the whole scene in the free part of the window,
// lines that can be seen, axes, level lines, values of springs, themes. Runs against the executable in
// TRUESTEP_BINARY.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import { ask, open, pixels, settled, until } from "./pixels.mjs";
import { bad, page, url } from "./served.mjs";

let warned = [];

before(async () => {
  page.on("console", (message) => message.type() === "warning" && warned.push(message.text()));
});

const whole = { x: 0, y: 56, width: 1280, height: 640 };
const red = [0.9, 0.06, 0.06];
const isRed = (r, g, b) => r > 60 && r > 2.2 * g && r > 2.2 * b;
const light = ([r, g, b]) => 0.3 * r + 0.6 * g + 0.1 * b;
const weightless = { time: { dt: 0.01, duration: 100 }, gravity: [0, 0, 0] };

test("a rigid body throws a shadow, and nothing is read while it is drawn", async () => {
  warned = [];
  const floor = { type: "box", motion: "fixed", half_extents: [6, 0.1, 6], position: [0, -0.1, 0], color: [0.7, 0.7, 0.7] };
  const box = { type: "box", half_extents: [0.5, 0.5, 0.5], position: [0, 1.2, 0], color: red };
  const view = { camera: { eye: [0, 7, 7], target: [0, 0, 0] } };
  const scene = (bodies) => ({ ...weightless, viewer: view, systems: [{ type: "rigid3d", id: "b", bodies, sleeping: false }] });
  await open(page, url, scene([floor, box]));
  // A slow machine draws the shadow when nothing moves any more.
  let counts;
  await until(page, async () => {
    const shaded = await pixels(page, whole);
    const body = shaded.where(isRed);
    if (body.length < 500) return false;
    const [x0, y0] = body.reduce(([x, y], [u, v]) => [x + u / body.length, y + v / body.length], [0, 0]);
    const floorLight = [];
    for (let dx = -260; dx <= 260; dx += 10) {
      for (let dy = -200; dy <= 200; dy += 10) {
        const color = shaded.at(x0 + dx, y0 + dy);
        if (!isRed(...color)) floorLight.push(light(color));
      }
    }
    floorLight.sort((a, b) => a - b);
    const usual = floorLight[Math.floor(0.7 * floorLight.length)];
    counts = { dark: floorLight.filter((c) => c < 0.7 * usual).length, of: floorLight.length };
    return counts.dark > 30;
  }, "a part of the floor lies in the shadow");
  assert.ok(counts.dark < 0.4 * counts.of, `and most does not: ${JSON.stringify(counts)}`);
  assert.deepEqual(warned.filter((text) => /GL_INVALID|feedback/i.test(text)), []);
});

test("a liquid is drawn as a smooth surface, and as particles when that is switched off", async () => {
  // A cube of 1,000 particles from the front: a plane as a surface, a chessboard of balls and gaps without.
  const water = { type: "sph", id: "w", low: [-1, -1, -1], high: [1, 1, 1], spacing: 0.05, bodies: [{ half_extents: [0.25, 0.25, 0.25] }] };
  const view = { camera: { eye: [0, 0, 1.6], target: [0, 0, 0] } };
  const middle = { x: 590, y: 330, width: 100, height: 100 };
  const roughness = async () => {
    const shot = await pixels(page, middle);
    let sum = 0;
    for (let y = 330; y < 429; ++y) for (let x = 590; x < 689; ++x) sum += Math.abs(light(shot.at(x + 1, y)) - light(shot.at(x, y)));
    return sum / (99 * 99);
  };
  await open(page, url, { ...weightless, systems: [water], viewer: { ...view, liquid: "surface" } });
  let smooth, rough;
  await until(page, async () => (smooth = await roughness()) < 0.3, "the face of the cube is smooth");
  await page.click("#show-surface");
  await until(page, async () => (rough = await roughness()) > 1.5, "balls, when the surface is switched off");
  await page.click("#show-surface");
  await until(page, async () => (await roughness()) < 0.3, "smooth again");
  const shot = await pixels(page, whole);
  assert.ok(Math.abs(light(shot.at(640, 380)) - light(shot.at(200, 380))) > 5, "and not the empty background");
  await open(page, url, { ...weightless, systems: [water], viewer: view });
  await until(page, async () => (await roughness()) > 1.5, "control: balls, when the scene asks for none");
  assert.equal(await page.locator("#show-surface").isVisible(), false);
  assert.ok(rough > 5 * smooth, `${rough} beside ${smooth}`);
});

test("a machine that lost quality draws the resting picture in full", async () => {
  await page.goto(`${url}/?gallery=box_of_particles`);
  await until(page, () => page.evaluate(() => document.getElementById("view").width < 0.9 * window.innerWidth), "fewer pixels where drawing is slow");
  await page.click("#play");
  await until(page, () => page.evaluate(() => document.getElementById("view").width === window.innerWidth), "all pixels when it rests");
});

/** Sizes of a desktop and of a phone, and what of them is free of panels. */
const windows = [
  { width: 1280, height: 800, free: { left: 0, right: 1280, top: 50, bottom: 710 } },
  { width: 390, height: 844, free: { left: 0, right: 390, top: 50, bottom: 754 } },
];

for (const { width, height, free } of windows) {
  test(`what moves away stays inside the free part of ${width} x ${height}`, async () => {
    await page.setViewportSize({ width, height });
    const ball = { type: "sphere", radius: 0.3, position: [0, 0, 0], velocity: [1.5, 1, 0], color: red };
    const still = { type: "box", half_extents: [0.3, 0.3, 0.3], position: [0, 0, 0.9], color: [0.1, 0.1, 0.9] };
    const id = await open(page, url, { ...weightless, systems: [{ type: "rigid3d", id: "b", bodies: [ball, still], sleeping: false }] });
    for (const seconds of [2, 2]) {
      await ask(url, `/v1/sessions/${id}/step`, { seconds });
      // Frames come while it plays: a few more, so that the frame is looked at, and its move ends.
      for (let k = 0; k < 4; ++k) {
        await ask(url, `/v1/sessions/${id}/step`, { steps: 1 });
        await page.waitForTimeout(350);
      }
      await settled(page);
      const picture = await pixels(page, { x: 0, y: 0, width, height });
      for (const [what, wanted] of [["ball", isRed], ["box", (r, g, b) => b > 60 && b > 2 * r && b > 2 * g && b - g > 60]]) {
        const found = picture.where(wanted).filter(([, y]) => y > free.top && y < free.bottom);
        assert.ok(found.length > 12, `the ${what} is seen`);
        const xs = found.map(([x]) => x);
        const ys = found.map(([, y]) => y);
        assert.ok(Math.min(...xs) > free.left + 2 && Math.max(...xs) < free.right - 3, `${what}: ${Math.min(...xs)} to ${Math.max(...xs)}`);
        assert.ok(Math.min(...ys) > free.top && Math.max(...ys) < free.bottom, `${what}: ${Math.min(...ys)} to ${Math.max(...ys)}`);
      }
    }
    await page.setViewportSize({ width: 1280, height: 800 });
  });
}

test("a rope is a line of three pixels at least", async () => {
  // Two springs of a rope that lies level: no points of their own, the first colour of the palette.
  const free = { points: [[-1, 0, 0], [-0.2, 0, 0], [1, 0, 0]], masses: [1, 1, 1], springs: [{ a: 0, b: 1, stiffness: 1, rest_length: 0.8 }, { a: 1, b: 2, stiffness: 1, rest_length: 1.2 }] };
  await open(page, url, { ...weightless, viewer: { camera: { eye: [0, 0, 9], target: [0, 0, 0] } }, systems: [{ type: "mass_spring", id: "rope", free, pins: [0, 1, 2] }] });
  const columns = new Map();
  for (const [x] of (await pixels(page, whole)).where((r, g, b) => b > 90 && b > 1.3 * g && b > 2 * r)) columns.set(x, (columns.get(x) ?? 0) + 1);
  const widths = [...columns.values()].sort((a, b) => a - b);
  assert.ok(widths.length > 100, `${widths.length} columns`);
  assert.ok(widths[Math.floor(0.1 * widths.length)] >= 3, `${widths.slice(0, 20)}`);
});

test("equations are drawn with axes, round values and names", async () => {
  await page.goto(`${url}/?gallery=hires`);
  await until(page, async () => (await page.$$('.labels [data-kind="axis"]')).length === 2, "two axes");
  const texts = async (kind) => page.$$eval(`.labels [data-kind="${kind}"]`, (spans) => spans.map((span) => span.textContent));
  assert.deepEqual(await texts("axis"), ["t (s)", "concentration"]);
  assert.deepEqual((await texts("tick-x")).slice(0, 3), ["0", "100", "200"]);
  // The plot shows a logarithm: its values are decades.
  assert.ok((await texts("tick-y")).some((text) => /^0\.0*1$/.test(text)), (await texts("tick-y")).join());
});

test("level lines are drawn over a plate that asks for them", async () => {
  const plate = { type: "heat", id: "plate", cells: [24, 24], initial: "x" };
  const view = { range: [0, 1] };
  const dark = async (viewer) => {
    await open(page, url, { time: { dt: 1e-6 }, gravity: [0, 0, 0], viewer, systems: [plate] });
    const picture = await pixels(page, { x: 500, y: 250, width: 280, height: 250 });
    return picture.where((r, g, b) => r + g + b < 110).length;
  };
  const plain = await dark(view);
  const lined = await dark({ ...view, contours: 7 });
  assert.ok(lined > plain + 200, `${plain} dark places without, ${lined} with level lines`);
});

test("springs are coloured by their values, and the legend says what they mean", async () => {
  const springs = [{ a: 0, b: 1, stiffness: 1, rest_length: 1 }, { a: 2, b: 3, stiffness: 1, rest_length: 0.5 }];
  const free = { points: [[-1, 0.4, 0], [0, 0.4, 0], [-1, -0.4, 0], [0, -0.4, 0]], masses: [1, 1, 1, 1], springs };
  await open(page, url, { ...weightless, viewer: { color_by: "strain", range: [0, 1] }, systems: [{ type: "mass_spring", id: "two", free, pins: [0, 1, 2, 3] }] }, { bare: false });
  await until(page, () => page.locator("#scale").isVisible(), "a legend");
  assert.match(await page.textContent("#scale"), /^\s*strain/);
  const picture = await pixels(page, { x: 0, y: 56, width: 960, height: 640 });
  const yellow = picture.where((r, g, b) => r > 150 && g > 140 && b < 120).length;
  const violet = picture.where((r, g, b) => b > 45 && b > 1.5 * g && r > g && r < 140).length;
  assert.ok(yellow > 100 && violet > 100, `${yellow} places of the stretched spring, ${violet} of the other`);
});

test("one colour bar explains the colours of all systems", async () => {
  // Two balls at 1 and 4 m/s: only the fast one is at the yellow end.
  const one = (id, x, speed) => ({ type: "rigid3d", id, sleeping: false, bodies: [{ type: "sphere", radius: 0.4, position: [x, 0, 0], velocity: [0, 0, speed] }] });
  const yellow = async (systems) => {
    await open(page, url, { ...weightless, viewer: { color_by: "speed", camera: { eye: [0, 0, 9], target: [0, 0, 0] } }, systems });
    await settled(page);
    return (await pixels(page, whole)).where((r, g, b) => r > 110 && g > 100 && b < 0.6 * r);
  };
  const both = await yellow([one("slow", -1.5, 1), one("fast", 1.5, 4)]);
  assert.ok(both.length > 300 && both.every(([x]) => x > 640), `${both.length} places`);
  assert.ok((await yellow([one("slow", -1.5, 1), one("slower", 1.5, 0.2)])).some(([x]) => x < 640), "control: beside a slower one, it is the fastest");
});

test("systems are named where they are, and strings of joints are drawn", async () => {
  await page.goto(`${url}/?gallery=damping_kinds`);
  await until(page, async () => (await page.$$('.labels [data-kind="name"]')).length === 3, "three names");
  const names = await page.$$eval(".labels span", (spans) => spans.map((span) => span.textContent).sort());
  assert.deepEqual(names, ["internal", "undamped", "viscous"]);
  const disk = { shapes: [{ type: "circle", radius: 0.2 }], position: [0, 0, 0], color: red };
  const scene = (joints) => ({ ...weightless, systems: [{ type: "rigid2d", id: "p", bodies: [disk], joints }] });
  const lit = async (joints) => {
    await open(page, url, scene(joints));
    const picture = await pixels(page, whole);
    return picture.where((r, g, b) => Math.min(r, g, b) > 90).length;
  };
  const none = await lit([]);
  const string = await lit([{ type: "distance", a: -1, b: 0, anchor: [0, 2, 0], anchor_b: [0, 0, 0] }]);
  assert.ok(string > none + 150, `${none} light places without a string, ${string} with it`);
});

test("copies of a body hang on strings too", async () => {
  const ball = { type: "sphere", radius: 0.1, position: [-0.5, 0, 0], color: red, copies: { layout: "grid", count: [3, 1, 1], spacing: [0.5, 1, 1] } };
  const lit = async (joints) => {
    await open(page, url, { ...weightless, systems: [{ type: "rigid3d", id: "p", bodies: [ball], joints }] });
    return (await pixels(page, whole)).where((r, g, b) => Math.min(r, g, b) > 90).length;
  };
  const none = await lit([]);
  const strings = await lit([{ type: "distance", a: -1, b: 0, anchor: [-0.5, 1, 0], anchor_b: [-0.5, 0, 0], repeat: 3, offset: [0.5, 0, 0] }]);
  assert.ok(strings > none + 300, `${none} light places without strings, ${strings} with them`);
});

test("a light theme is light, and stays when the page comes again", async () => {
  await open(page, url, { ...weightless, systems: [{ type: "rigid3d", id: "b", bodies: [{ type: "sphere", radius: 0.3, color: red }] }] });
  const corner = async () => light((await pixels(page, { x: 40, y: 640, width: 20, height: 20 })).at(50, 650));
  assert.ok((await corner()) < 60, "dark at first");
  await page.keyboard.press("l");
  assert.ok((await corner()) > 180, "light");
  await page.reload();
  await until(page, async () => (await page.textContent("#read-frame")) !== "0", "a frame");
  assert.ok((await corner()) > 180, "light again");
  await page.keyboard.press("l");
  assert.ok((await corner()) < 60, "and dark");
});

test("nothing was written to the console as an error", () => assert.deepEqual(bad, []));
