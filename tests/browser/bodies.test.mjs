// Rigid bodies in the viewer, read back from its pixels: a body of a colour appears where it should, every shape is
// drawn, sleepers are darker, contacts and joints come and go, a body is pulled where the mouse holds it, and a bad
// body is named in the editor. Runs against the executable in TRUESTEP_BINARY.
import assert from "node:assert/strict";
import { test } from "node:test";
import { patience } from "./chromium.mjs";
import { settled } from "./pixels.mjs";
import { bad, page, url } from "./served.mjs";

async function ask(path, body) {
  const response = await fetch(url + path, { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(body) });
  const answer = await response.json();
  assert.ok(response.ok, JSON.stringify(answer));
  return answer;
}

async function until(condition, what) {
  const end = Date.now() + patience;
  while (!(await condition())) {
    if (Date.now() > end) assert.fail(`timed out: ${what}`);
    await page.waitForTimeout(100);
  }
}

const camera = { eye: [0, 1, 12], target: [0, 1, 0] };

/** Opens a paused session of these bodies, seen from the front. */
async function open(bodies, more = {}) {
  const { id } = await ask("/v1/sessions", { time: { dt: 1 / 60, duration: 100 }, viewer: { camera }, systems: [{ type: "rigid3d", id: "bodies", bodies, ...more }] });
  await page.goto(`${url}/?session=${id}`);
  await until(async () => (await page.textContent("#read-frame")) !== "0", "a frame is shown");
  if (await page.$eval("#side", (side) => !side.hidden)) await page.keyboard.press("m");
  return id;
}

/** Red, green and blue of the picture, averaged over 9 x 9 pixels around (x, y). */
async function colorAt(x, y) {
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  const png = (await page.screenshot({ clip: { x: x - 4, y: y - 4, width: 9, height: 9 } })).toString("base64");
  return page.evaluate(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const canvas = document.createElement("canvas");
    canvas.width = canvas.height = 9;
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const all = context.getImageData(0, 0, 9, 9).data;
    return [0, 1, 2].map((c) => all.filter((_, k) => k % 4 === c).reduce((sum, v) => sum + v, 0) / 81);
  }, png);
}

/** Where a point of the plane z = 0 is on the screen: nine tenths of the free part show 0.8 of the scene's own frame. */
async function pixel(x, y) {
  const box = await page.locator("#view").boundingBox();
  // The transport covers 90 pixels, the top 50.
  const height = await page.evaluate(() => window.innerHeight);
  const distance = (0.8 * 12) / ((0.9 * (height - 140)) / height);
  const metre = height / (2 * distance * Math.tan((20 * Math.PI) / 180));
  return [box.x + box.width / 2 + x * metre, box.y + (height - 40) / 2 - (y - 1) * metre];
}

const red = [0.9, 0.08, 0.08];
const blue = [0.1, 0.15, 0.9];
const points = [[0.8, 0, 0], [-0.8, 0, 0], [0, 0.8, 0], [0, -0.8, 0], [0, 0, 0.8], [0, 0, -0.8]];
const still = { gravity: [0, 0, 0], sleeping: false };

test("every shape is drawn where it is, in its colour", async () => {
  const shapes = [
    { type: "box", half_extents: [0.6, 0.6, 0.6] }, { type: "sphere", radius: 0.7 }, { type: "capsule", radius: 0.5, half_length: 0.4 },
    { type: "cylinder", radius: 0.6, half_length: 0.6 }, { type: "hull", points },
    { type: "compound", parts: [{ type: "box", half_extents: [0.3, 0.6, 0.6], position: [-0.3, 0, 0] }, { type: "sphere", radius: 0.6, position: [0.3, 0, 0] }] },
  ];
  for (const shape of shapes) {
    await open([{ ...shape, position: [-1.5, 1, 0], color: red }, { ...shape, position: [1.5, 1, 0], color: blue }], still);
    const left = await colorAt(...(await pixel(-1.5, 1)));
    const right = await colorAt(...(await pixel(1.5, 1)));
    assert.ok(left[0] > 2 * left[2] && left[0] > 60, `${shape.type} left: ${left}`);
    assert.ok(right[2] > 2 * right[0] && right[2] > 60, `${shape.type} right: ${right}`);
    // Nothing is between them.
    const between = await colorAt(...(await pixel(0, 1)));
    assert.ok(Math.max(...between) < 60, `${shape.type} between: ${between}`);
  }
});

test("a body asleep is darker, and bright again when it is woken", async () => {
  const id = await open([{ type: "plane", motion: "fixed" }, { type: "box", half_extents: [1, 1, 1], position: [0, 1, 0], color: red }]);
  const awake = await colorAt(...(await pixel(0, 1)));
  await ask(`/v1/sessions/${id}/step`, { seconds: 3 });
  await until(async () => (await colorAt(...(await pixel(0, 1))))[0] < 0.85 * awake[0], "it falls asleep");
  await ask(`/v1/sessions/${id}/commands`, { type: "impulse", system: "bodies", index: 1, impulse: [1, 0, 0] });
  await ask(`/v1/sessions/${id}/step`, { steps: 1 });
  await until(async () => (await colorAt(...(await pixel(0, 1))))[0] > 0.95 * awake[0], "it wakes");
});

test("contacts and joints are drawn on request only", async () => {
  const id = await open(
    [{ type: "plane", motion: "fixed" }, { type: "box", half_extents: [1, 1, 1], position: [0, 1, 0] }, { type: "sphere", radius: 0.3, position: [2, 2, 0] }],
    { joints: [{ type: "hinge", a: -1, b: 2, anchor: [2, 2.6, 0], axis: [0, 0, 1] }], sleeping: false },
  );
  await ask(`/v1/sessions/${id}/step`, { steps: 30 });
  await until(async () => (await page.textContent("#read-step")) === "30", "step 30");
  const view = async () => {
    await settled(page);
    return page.screenshot({ clip: { x: 300, y: 100, width: 680, height: 560 } });
  };
  const plain = await view();
  for (const key of ["k", "j"]) {
    await page.keyboard.press(key);
    const marked = await view();
    assert.ok(!marked.equals(plain), `${key} shows something`);
    await page.keyboard.press(key);
    assert.ok((await view()).equals(plain), `${key} again hides it`);
  }
});

test("a body follows the mouse", async () => {
  const id = await open([{ type: "box", half_extents: [0.6, 0.6, 0.6], position: [0, 1, 0], color: red }], still);
  const from = await pixel(0, 1);
  await page.mouse.move(...from);
  await until(() => page.locator("#probe").isVisible(), "the body is marked");
  await page.mouse.down();
  await page.mouse.move(from[0], from[1] - 40, { steps: 3 });
  await page.mouse.move(from[0], from[1] - 140, { steps: 5 });
  const height = async () => Number((await page.textContent("#probe span")).trim().split(/\s+/)[1]);
  await ask(`/v1/sessions/${id}/play`, { speed: 1 });
  await until(async () => (await height()) > 1.5, "it rises");
  await page.mouse.up();
});

test("a grid shows its values in colours, and what they mean", async () => {
  const plate = { type: "heat", id: "plate", cells: [16, 16], initial: "x" };
  const view = { camera: { eye: [0.5, 0.5, 2.5], target: [0.5, 0.5, 0] }, range: [0, 1] };
  const { id } = await ask("/v1/sessions", { time: { dt: 1e-6 }, gravity: [0, 0, 0], viewer: view, systems: [plate] });
  await page.goto(`${url}/?session=${id}`);
  await until(async () => (await page.textContent("#read-frame")) !== "0", "a frame is shown");
  await until(() => page.locator("#scale").isVisible(), "the scale is shown");
  assert.match(await page.textContent("#scale"), /value \(K\)\s*01/);
  const box = await page.locator("#view").boundingBox();
  // The measurements on the right take 316 pixels.
  const at = (share) => colorAt(Math.round(box.x + (box.width - 316) / 2 + share * 0.16 * box.height), Math.round(box.y + 0.47 * box.height));
  const [cold, hot] = [await at(-1), await at(1)];
  // Viridis: violet below, yellow above. The control: the two sides differ, and neither is the background.
  assert.ok(cold[2] > 1.3 * cold[1] && cold[2] > 60, `cold: ${cold}`);
  assert.ok(hot[1] > 1.3 * hot[2] && hot[1] > 120, `hot: ${hot}`);
});

test("nothing was written to the console as an error so far", () => assert.deepEqual(bad, []));

test("a body that cannot be is named in the editor", async () => {
  await page.goto(url);
  await page.waitForSelector("#gallery [data-scene]");
  await page.click("#tab-editor");
  const scene = { time: { dt: 0.01 }, systems: [{ type: "rigid3d", id: "b", bodies: [{ type: "box", half_extents: [0.5, 0, 0.5] }, { type: "hull", points: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]] }, { type: "cylindre" }] }] };
  await page.fill("#scene-text", JSON.stringify(scene, null, 2));
  await page.click("#validate");
  await page.locator("#findings .pointer", { hasText: "/systems/0/bodies/0/half_extents" }).first().waitFor();
  const text = await page.textContent("#findings");
  assert.match(text, /\/systems\/0\/bodies\/2\/type/);
  assert.match(text, /cylinder/);
  scene.systems[0].bodies = [scene.systems[0].bodies[1]];
  await page.fill("#scene-text", JSON.stringify(scene, null, 2));
  await page.click("#create");
  await page.locator("#findings .pointer", { hasText: "/bodies/0" }).first().waitFor();
  assert.match(await page.textContent("#findings"), /plane|flat|hull/);
});
