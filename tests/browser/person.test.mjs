// What a person expects of the page beside the picture: chapters and search, cards that play, speeds, the past in
// plots, a choice of observables, the scene's own text, a body held by a double click, an address that comes back.
// Runs against the executable in TRUESTEP_BINARY.
import assert from "node:assert/strict";
import { test } from "node:test";
import { ask, open, sessionOf, until } from "./pixels.mjs";
import { bad, expected, page, url } from "./served.mjs";

const seen = () => page.$$eval("#gallery article", (cards) => cards.filter((card) => card.offsetParent !== null).map((card) => card.dataset.scene));

test("the gallery has chapters, and a search finds scenes by what they teach", async () => {
  await page.goto(url);
  await page.waitForSelector("#gallery [data-scene]");
  const all = await seen();
  assert.ok((await page.$$(".chapter h2")).length >= 5);
  await page.fill("#search", "pendulum");
  const found = await seen();
  assert.ok(found.length > 0 && found.length < all.length / 3 && found.includes("pendulum_reference_2d"), found.join());
  await page.fill("#search", "no such thing");
  assert.deepEqual(await seen(), []);
  assert.ok(await page.locator(".empty").isVisible());
  await page.fill("#search", "");
  assert.deepEqual(await seen(), all);
});

test("a card plays under the mouse, and its session ends with it", async () => {
  const card = '#gallery .run[data-scene="terminal_velocity"]';
  await page.locator(card).scrollIntoViewIfNeeded();
  const still = await page.getAttribute(`${card} img`, "src");
  await page.hover(card);
  await until(page, async () => Number(await page.getAttribute(`${card} .thumbnail`, "data-playing")) >= 3, "three pictures");
  await page.mouse.move(2, 2);
  await until(page, async () => (await page.getAttribute(`${card} img`, "src")) === still || new URL(await page.$eval(`${card} img`, (image) => image.src)).pathname === still, "the still comes back");
  await until(page, async () => (await (await fetch(`${url}/v1/sessions`)).json()).sessions.length === 0, "no session is left");
});

test("speeds go to a thousand where the step fits, and a short scene is slowed down", async () => {
  await page.goto(`${url}/?gallery=van_der_pol_stiff`);
  await until(page, async () => (await page.textContent("#read-frame")) !== "0", "a frame");
  const speeds = await page.$$eval("#speed option", (options) => options.map((option) => Number(option.value)));
  assert.ok(speeds.includes(1000), speeds.join());
  await until(page, async () => Number((await page.textContent("#read-time")).replace(/[^\d.]/g, "")) > 50, "it plays fast by itself");
  await page.goto(`${url}/?gallery=heat_plate`);
  await until(page, async () => (await page.textContent("#read-frame")) !== "0", "a frame");
  assert.ok(Number(await page.inputValue("#speed")) < 0.01, await page.inputValue("#speed"));
  // As well where a request made the session; one that a request has stepped keeps its speed.
  for (const [steps, suits] of [[0, (speed) => speed < 0.01], [1, (speed) => speed === 1]]) {
    const { id } = await ask(url, "/v1/sessions", { gallery: "heat_plate" });
    if (steps) await ask(url, `/v1/sessions/${id}/step`, { steps });
    await page.goto(`${url}/?session=${id}`);
    await until(page, async () => (await page.textContent("#read-frame")) !== "0" || (await page.$$("#speed option")).length > 0, "its speeds");
    await until(page, async () => suits(Number(await page.inputValue("#speed"))), `a speed after ${steps} steps`);
  }
});

const spring = { time: { dt: 0.01, duration: 20 }, gravity: [0, 0, 0], observables: ["energy", "s.strain.max"], systems: [{ type: "mass_spring", id: "s", free: { points: [[0, 0, 0], [1.5, 0, 0]], masses: [1, 1], springs: [{ a: 0, b: 1, stiffness: 9, rest_length: 1 }] } }] };

test("a plot begins at the start for a page that comes late, with six digits, and other observables to choose", async () => {
  const { id } = await ask(url, "/v1/sessions", spring);
  await ask(url, `/v1/sessions/${id}/step`, { seconds: 3 });
  await page.goto(`${url}/?session=${id}`);
  await until(page, async () => (await page.$$("#legend button")).length === 3, "energies");
  // The line is as long as the past: nothing else was received than the present.
  await until(page, () => page.$eval("#plot canvas", (canvas) => {
    const { width, height } = canvas;
    const data = canvas.getContext("2d").getImageData(0, 0, width, height).data;
    let columns = 0;
    for (let x = 0; x < width; ++x) {
      let strong = 0;
      for (let y = 0; y < height; ++y) {
        const k = 4 * (y * width + x);
        if (data[k + 3] > 120 && Math.max(data[k], data[k + 1], data[k + 2]) - Math.min(data[k], data[k + 1], data[k + 2]) > 60) ++strong;
      }
      if (strong > 0) ++columns;
    }
    return columns > 0.6 * width;
  }), "the past is drawn");
  const total = '#legend button[title="energy.total"] b';
  const { latest } = await (await fetch(`${url}/v1/sessions/${id}/observables`)).json();
  const six = (value) => String(+value.toPrecision(6)).replace("-", "−");
  await until(page, async () => (await page.textContent(total)) === six(latest["energy.total"]), "six digits of the energy");
  await page.click("#choose summary");
  await page.check('#choose-list label:has-text("s.strain.max") input');
  assert.ok((await page.textContent("#legend")).includes("s.strain.max"));
  await page.click("#choose summary");
  await page.click("#drift");
  assert.match(await page.textContent("#energy-title"), /since the start/);
  // 1.125 J at the start: k (l - l0)^2 / 2.
  await until(page, async () => (await page.textContent(total)) === six((latest["energy.total"] - 1.125) / 1.125), "the change over the value at the start");
  await page.click("#drift");
});

test("the editor has the session's own scene", async () => {
  const { id } = await ask(url, "/v1/sessions", { ...spring, name: "one of mine" });
  await page.goto(`${url}/?session=${id}`);
  await until(page, async () => (await page.textContent("#read-frame")) !== "0", "a frame");
  await page.keyboard.press("e");
  assert.equal(JSON.parse(await page.inputValue("#scene-text")).name, "one of mine");
});

test("a double click holds a body in space, another lets it go", async () => {
  const scene = { time: { dt: 0.01, duration: 20 }, viewer: { camera: { eye: [0, 0, 10], target: [0, 0, 0] } }, systems: [{ type: "rigid3d", id: "b", bodies: [{ type: "box", half_extents: [1, 1, 1], position: [0, 0, 0] }] }] };
  const id = await open(page, url, scene);
  await page.mouse.dblclick(640, 380);
  await until(page, async () => /held|pinned/.test(await page.textContent("#hint")), "it says that the body is held");
  await ask(url, `/v1/sessions/${id}/step`, { seconds: 1 });
  const height = async () => (await (await fetch(`${url}/v1/sessions/${id}/frames/latest`, { headers: { accept: "application/json" } })).json()).blocks?.[0]?.data?.[1];
  const held = await height();
  await page.waitForTimeout(500);
  await page.mouse.dblclick(640, 380);
  await until(page, async () => /free$/.test(await page.textContent("#hint")), "it says that the body is free");
  await ask(url, `/v1/sessions/${id}/step`, { seconds: 1 });
  // Free it falls 4.9 m in a second; held by a spring it has hardly moved.
  if (held !== undefined) assert.ok(Math.abs(held) < 1 && (await height()) < held - 3, `${held} ${await height()}`);
  assert.equal(await page.locator("#problems .card").count(), 0);
});

test("an address makes scene, time and camera again when its session is gone", async () => {
  await page.goto(`${url}/?gallery=flag`);
  await until(page, async () => Number((await page.textContent("#read-time")).replace(/[^\d.]/g, "")) > 0.2, "it plays");
  await page.keyboard.press("Space");
  await page.focus("#view");
  await page.keyboard.press("ArrowLeft");
  await until(page, () => /eye=/.test(page.url()) && /t=/.test(page.url()), "the address says so");
  let address = "";
  await until(page, async () => {
    const before = address;
    address = page.url();
    await page.waitForTimeout(2600);
    return page.url() === address && address === before;
  }, "the address stands still");
  const time = Number(/t=([\d.]+)/.exec(address)[1]);
  const id = await sessionOf(page);
  await page.goto("about:blank");
  assert.equal((await fetch(`${url}/v1/sessions/${id}`, { method: "DELETE" })).ok, true);
  expected(/404/);
  await page.goto(address);
  await until(page, async () => Math.abs(Number((await page.textContent("#read-time")).replace(/[^\d.]/g, "")) - time) < 0.05, "the same time");
  const eye = /eye=([^&]+)/.exec(address)[1];
  await until(page, async () => page.url().includes(eye) && (await sessionOf(page)) !== id, "the same camera in another session");
});

test("only what was gone was written to the console as an error", () => assert.deepEqual(bad.filter((text) => !/status of 4(04|10|22)/.test(text)), []));
