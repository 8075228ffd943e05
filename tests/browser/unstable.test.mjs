// A run that becomes unstable under the eyes of a person: what the page says, and how one gets on. Runs against the executable in
// TRUESTEP_BINARY.
import assert from "node:assert/strict";
import { test } from "node:test";
import { ask, open, sessionOf, until } from "./pixels.mjs";
import { bad, page, url } from "./served.mjs";

// Two masses of 1 kg on 900 N/m: symplectic Euler grows beyond 2 / omega = 2 / sqrt(1800 / s^2) = 47.1 ms, at 47.2 ms slowly enough
// for a past to go back to. Half of it holds: the control. (At a tenth less it swings so far that the masses pass through each
// other, and gains.)
const spring = (dt) => ({
  name: "stiff spring", time: { dt, duration: 20 }, gravity: [0, 0, 0],
  systems: [{ type: "mass_spring", id: "spring", integrator: "symplectic_euler", free: { points: [[0, 0, 0], [1.5, 0, 0]], masses: [1, 1], springs: [{ a: 0, b: 1, stiffness: 900, rest_length: 1 }] } }],
});
const shownTime = async () => Number((await page.textContent("#read-time")).replace(/[^\d.]/g, ""));
const session = async (id) => (await fetch(`${url}/v1/sessions/${id}`)).json();
const label = () => page.getAttribute("#play", "aria-label");
const cards = () => page.textContent("#problems");
const idShown = () => sessionOf(page);

/** Plays until the page says that the run has become unstable. */
async function fall() {
  await page.click("#play");
  await until(page, async () => /became unstable/.test(await cards()), "a card says so");
  await until(page, async () => (await label()) === "Play", "it does not play on");
}

test("a run that becomes unstable says what, when and what would help, and stands at its last good step", async () => {
  const id = await open(page, url, spring(0.0472));
  await fall();
  const { instability, time, status } = await session(id);
  assert.equal(status, "unstable");
  assert.ok(time > 0.5, `it held for ${time} s`);
  const text = await cards();
  assert.match(text, /system "spring": energy rose from [\d.]+ J to [\d.e+]+ J without a source/i);
  assert.match(text, /in step \d+ \(t = [\d.]+ s\)/);
  assert.match(text, /What would help.*A step of 0\.0236\d* s/i);
  assert.match(text, /implicit_euler/);
  assert.match(text, /suggested dt:?\s*0\.0236\d* s/);
  for (const number of text.match(/[\d.]+(?= J)/g)) assert.ok(number.length <= 8, `${number} J has more digits than are read`);
  assert.equal(await page.locator("#problems .status").count(), 0, "nobody asked for a status of HTTP");
  await until(page, async () => Math.abs((await shownTime()) - time) < 1e-3, "the last good step is shown");
  assert.equal(instability.last_good_step, Math.round(time / 0.0472));
  // Another attempt says the same once more, in one card.
  await page.click("#problems .card [aria-label=Close]");
  await page.click("#play");
  await until(page, async () => (await page.locator("#problems .card").count()) === 1, "the card is there again");
  assert.equal(await label(), "Play");
  assert.equal(await cards(), text);
});

test("the bar of time leads back out of an unstable run", async () => {
  const id = await open(page, url, spring(0.0472));
  await fall();
  await page.$eval("#seek", (bar) => {
    bar.value = "25";
    bar.dispatchEvent(new Event("input"));
    bar.dispatchEvent(new Event("change"));
  });
  await until(page, async () => (await shownTime()) < 0.6, "the picture of half a second");
  await until(page, async () => (await page.locator("#problems .card").count()) === 0, "the card is gone");
  assert.equal((await session(id)).status, "paused");
  await page.click("#step");
  await until(page, async () => (await session(id)).step === 12, "it steps");
  await fall();
});

test("an unstable run starts again from its card, and with a shorter step it holds", async () => {
  const id = await open(page, url, spring(0.0472));
  await fall();
  await page.click("#problems >> text=Start again");
  await until(page, async () => (await shownTime()) === 0 && (await page.locator("#problems .card").count()) === 0, "it is at its start");
  assert.equal((await session(id)).status, "paused");
  await fall();
  const { time } = await session(id);
  await page.click("#problems >> text=/Start with a step of 0.0236/");
  await until(page, async () => (await idShown()) !== id && (await shownTime()) > time + 1, "the shorter step has gone farther");
  assert.equal(await page.locator("#problems .card").count(), 0);
  assert.equal(await label(), "Pause");
  assert.equal((await session(await idShown())).dt, 0.0236);
});

test("another page that resets an unstable session takes its card back", async () => {
  const id = await open(page, url, spring(0.0472));
  await fall();
  await ask(url, `/v1/sessions/${id}/reset`, {});
  await until(page, async () => (await shownTime()) === 0 && (await page.locator("#problems .card").count()) === 0, "the card is gone");
});

test("a run that holds shows no card", async () => {
  const id = await open(page, url, spring(0.0236));
  await ask(url, `/v1/sessions/${id}/step`, { seconds: 15 });
  await until(page, async () => (await shownTime()) > 14, "it held");
  assert.equal(await page.locator("#problems .card").count(), 0);
  // Refused plays of unstable sessions are answered with 409, which a browser lists as an error.
  assert.deepEqual(bad.filter((text) => !/409/.test(text)), []);
});
