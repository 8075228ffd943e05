// What a person comes back to: an earlier moment by the bar of time, a session that ended under the open page, a server that
// was away; and scenes that are not upright along y. Runs against the executable in TRUESTEP_BINARY.
import assert from "node:assert/strict";
import { test } from "node:test";
import { ask, open, pixels, sessionOf, settled, until } from "./pixels.mjs";
import { bad, browser, expected, page, url } from "./served.mjs";

const spring = { time: { dt: 0.01, duration: 20 }, gravity: [0, 0, 0], systems: [{ type: "mass_spring", id: "s", free: { points: [[0, 0, 0], [1.5, 0, 0]], masses: [1, 1], springs: [{ a: 0, b: 1, stiffness: 9, rest_length: 1 }] } }] };
const shownTime = async () => Number((await page.textContent("#read-time")).replace(/[^\d.]/g, ""));
const session = async (id) => (await fetch(`${url}/v1/sessions/${id}`)).json();

test("the bar of time goes back to a moment, and ahead", async () => {
  const id = await open(page, url, spring);
  await ask(url, `/v1/sessions/${id}/step`, { seconds: 8 });
  await until(page, async () => (await page.inputValue("#seek")) === "400", "the bar is at 8 of 20 s");
  for (const [part, time] of [[125, 2.5], [600, 12]]) {
    await page.$eval("#seek", (bar, value) => {
      bar.value = value;
      bar.dispatchEvent(new Event("input"));
      bar.dispatchEvent(new Event("change"));
    }, String(part));
    await until(page, async () => Math.abs((await shownTime()) - time) < 1e-3, `the picture of ${time} s`);
    assert.ok(Math.abs((await session(id)).time - time) < 1e-9);
  }
});

test("play makes a session again that was deleted under the page, where it was", async () => {
  await page.goto(`${url}/?gallery=flag`);
  await until(page, async () => (await shownTime()) > 0.3, "it plays");
  await page.click("#play");
  await until(page, async () => (await page.getAttribute("#play", "aria-label")) === "Play", "it is paused");
  await settled(page);
  const time = await shownTime();
  const id = await sessionOf(page);
  await fetch(`${url}/v1/sessions/${id}`, { method: "DELETE" });
  await until(page, async () => /closed/.test(await page.textContent("#connection")), "the page knows");
  assert.match(await page.textContent("#problems"), /session has ended/);
  await page.click("#play");
  await until(page, async () => (await page.getAttribute("#connection", "data-state")) === "open" && (await shownTime()) > time, "it plays on");
  assert.ok((await shownTime()) < time + 20);
  assert.notEqual(await sessionOf(page), id);
  assert.equal(await page.locator("#problems .card").count(), 0);
});

test("a card about a server that was away goes when the server is back", async () => {
  const sockets = [];
  await page.routeWebSocket(/\/stream$/, (socket) => {
    socket.connectToServer();
    sockets.push(socket);
  });
  await open(page, url, spring);
  await page.route(/\/play$/, (route) => route.abort());
  await page.click("#play");
  await until(page, async () => /does not answer/.test(await page.textContent("#problems")), "a card says so");
  await page.unroute(/\/play$/);
  await sockets[0].close({ code: 3001 });
  await until(page, async () => sockets.length > 1 && (await page.getAttribute("#connection", "data-state")) === "open", "live again");
  await until(page, async () => (await page.locator("#problems .card").count()) === 0, "no card is left");
  expected(/ERR_FAILED/);
});

test("a page that leaves a session does not take it away from another page", async () => {
  const context = await browser.newContext();
  const [first, second] = [await context.newPage(), await context.newPage()];
  try {
    await first.goto(`${url}/?gallery=flag`);
    await until(first, async () => Boolean(await sessionOf(first)), "it has a session");
    const id = await sessionOf(first);
    await second.goto(`${url}/?session=${id}`);
    await until(second, async () => (await second.textContent("#read-frame")) !== "0", "the second page shows it");
    await first.evaluate(() => [...document.querySelectorAll(".scene .run")].at(-1).click());
    await until(first, async () => ![id, null].includes(await sessionOf(first)), "the first page shows another scene");
    await second.waitForTimeout(500);
    const { status } = await session(id);
    assert.equal(status, "playing");
    assert.equal(await second.locator("#problems .card").count(), 0);
    // A page that is closed leaves it playing, too.
    await first.goto(`${url}/?gallery=flag`);
    await until(first, async () => ![id, null].includes(await sessionOf(first)), "another one");
    const other = await sessionOf(first);
    await second.goto(`${url}/?session=${other}`);
    await until(second, async () => (await second.textContent("#read-frame")) !== "0", "the second page shows it, too");
    await first.goto("about:blank");
    await second.waitForTimeout(500);
    assert.equal((await session(other)).status, "playing");
    // The control: of the last page that shows it, it is paused, and ended when that shows another one.
    await first.goto(`${url}/?gallery=flag`);
    await until(first, async () => Boolean(await sessionOf(first)), "a session of its own");
    const alone = await sessionOf(first);
    await until(first, async () => (await first.textContent("#read-frame")) !== "0", "it is shown");
    await first.evaluate(() => [...document.querySelectorAll(".scene .run")].at(-1).click());
    await until(first, async () => (await session(alone)).status === 404, "it is gone");
  } finally {
    await context.close();
  }
});

test("water whose gravity is along z lies, seen from its camera", async () => {
  const pool = { type: "heightfield_wave", id: "pool", cells: [32, 32], size: [8, 8], origin: [-4, -4, 0], bed: "-0.3" };
  await open(page, url, { time: { dt: 0.01 }, gravity: [0, 0, -9.81], viewer: { color_map: "water", range: [-1, 1], height: 1, camera: { eye: [0, -8.5, 8], target: [0, 0, 0] } }, systems: [pool] });
  await settled(page);
  const rows = new Map();
  for (const [x, y] of (await pixels(page, { x: 0, y: 60, width: 1280, height: 640 })).where((r, g, b) => b > 90 && b > 1.3 * r)) {
    const [low, high] = rows.get(y) ?? [x, x];
    rows.set(y, [Math.min(low, x), Math.max(high, x)]);
  }
  const widths = [...rows].sort(([a], [b]) => a - b).map(([, [low, high]]) => high - low);
  assert.ok(widths.length > 150, `${widths.length} rows of water`);
  const part = Math.floor(widths.length / 10);
  // From the front an upright square would be as wide above as below; 8 m in front of 16 m are about half as wide again.
  assert.ok(widths.at(-part) > 1.25 * widths[part], `${widths[part]} above, ${widths.at(-part)} below`);
});

test("a grid coloured by a number carries no arrows of its velocity", async () => {
  const flow = { type: "grid_fluid", id: "flow", cells: [32, 32], size: [1, 1], viscosity: 0.1, initial: ["1", "0"], side: { kind: "periodic" } };
  const dark = async (color_by) => {
    await open(page, url, { time: { dt: 0.01 }, gravity: [0, 0, 0], viewer: { color_by, range: [-1, 1] }, systems: [flow] });
    await settled(page);
    return (await pixels(page, { x: 500, y: 250, width: 280, height: 250 })).where((r, g, b) => r + g + b < 120).length;
  };
  assert.equal(await dark("vorticity"), 0);
  assert.ok((await dark("velocity")) > 200, "control: arrows of a velocity");
});

test("the names of axes are read in full on a phone", async () => {
  await page.setViewportSize({ width: 390, height: 844 });
  await page.goto(`${url}/?gallery=robertson`);
  await until(page, async () => (await page.$$('.labels [data-kind="axis"]')).length > 1, "axes have names");
  await page.click("#play"); // beside the picture stand numbers that change while it plays
  await settled(page, { x: 0, y: 100, width: 390, height: 560 });
  const ends = await page.$$eval('.labels [data-kind="axis"]', (names) => names.map((name) => [name.textContent, name.getBoundingClientRect().left, name.getBoundingClientRect().right]));
  for (const [name, left, right] of ends) assert.ok(left >= 0 && right <= 390, `${name} goes from ${left} to ${right}`);
  await page.setViewportSize({ width: 1280, height: 800 });
});

test("all controls of a scene of springs and bodies fit a phone", async () => {
  await page.setViewportSize({ width: 390, height: 844 });
  await page.goto(`${url}/?gallery=wrecking_ball`);
  await until(page, async () => (await page.textContent("#read-frame")) !== "0", "a frame");
  for (const control of await page.$$("#transport > button:visible, #transport > label:visible, #transport > details:visible")) {
    const box = await control.boundingBox();
    assert.ok(box.x >= 0 && box.x + box.width <= 390, `${await control.getAttribute("id")}: ${JSON.stringify(box)}`);
  }
  await page.setViewportSize({ width: 1280, height: 800 });
});

test("only what was gone was written to the console as an error", () => assert.deepEqual(bad.filter((text) => !/status of 4(04|10)/.test(text)), []));
