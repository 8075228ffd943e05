// What an address hands over: a run of one's own, sight of a run, or control of one. And runs that stop at the end of
// their scene, from the editor's first scene on. Runs against the executable in TRUESTEP_BINARY.
import assert from "node:assert/strict";
import { test } from "node:test";
import { ask, open, sessionOf, until } from "./pixels.mjs";
import { bad, browser, page, url } from "./served.mjs";

const spring = { name: "two masses", time: { dt: 0.01, duration: 200 }, gravity: [0, 0, 0], systems: [{ type: "mass_spring", id: "s", free: { points: [[0, 0, 0], [1.5, 0, 0]], masses: [1, 1], springs: [{ a: 0, b: 1, stiffness: 9, rest_length: 1 }] } }] };
const session = async (id) => (await fetch(`${url}/v1/sessions/${id}`)).json();
const shownTime = async (one) => Number((await one.textContent("#read-time")).replace(/[^\d.]/g, ""));
const framed = (one) => until(one, async () => (await one.textContent("#read-frame")) !== "0", "a frame is shown");
const paused = (one) => until(one, async () => (await one.getAttribute("#play", "aria-label")) === "Play", "it is paused");
/** The address once it stands still. */
async function addressOf(one) {
  let address = "";
  await until(one, async () => {
    const last = address;
    address = one.url();
    await one.waitForTimeout(2600);
    return one.url() === address && address === last;
  }, "the address stands still");
  return address;
}

async function sharedLinks(one) {
  await one.click("#share summary");
  await until(one, async () => (await one.inputValue("#share-watch")) !== "", "the links");
  const links = { own: await one.inputValue("#share-own"), watch: await one.inputValue("#share-watch") };
  await one.keyboard.press("Escape");
  return links;
}

/** `use` with a page of someone else: nothing of this browser's tabs is known to it. */
async function elsewhere(use) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
  try {
    await use(await context.newPage());
  } finally {
    await context.close();
  }
}

/** Runs a scene from the editor: the page's own session. */
async function own(scene) {
  await page.goto("about:blank");
  await page.goto(url);
  await page.waitForSelector("#gallery [data-scene]");
  await page.click("#tab-editor");
  if (scene) await page.fill("#scene-text", JSON.stringify(scene));
  await page.click("#create");
  await framed(page);
  return sessionOf(page);
}

test("a reload goes on with the same session", async () => {
  const id = await own(spring);
  await until(page, async () => (await shownTime(page)) > 0.5, "it plays");
  await page.click("#play");
  await paused(page);
  const address = await addressOf(page);
  assert.match(address, /\/#s=.*&t=/);
  const { time } = await session(id);
  await page.reload();
  await framed(page);
  assert.equal(await sessionOf(page), id);
  assert.equal((await session(id)).time, time);
  assert.equal(await addressOf(page), address);
  // It is still the page's own: another scene ends it.
  await page.evaluate(() => document.querySelector(".scene .run").click());
  await until(page, async () => (await session(id)).status === 404, "it is gone");
});

test("the way back from the studies goes on with it, too", async () => {
  const id = await own(spring);
  await page.click("#studies");
  await page.waitForSelector("#back");
  await page.click("#back");
  await framed(page);
  assert.equal(await sessionOf(page), id);
  assert.doesNotMatch(await addressOf(page), /session=/);
});

test("an address opened elsewhere makes a run of its own at that time; its reset leaves the first one alone", async () => {
  const id = await own(spring);
  await until(page, async () => (await shownTime(page)) > 1, "it plays");
  await page.click("#play");
  await paused(page);
  const address = await addressOf(page);
  const { time } = await session(id);
  await elsewhere(async (pupil) => {
    await pupil.goto(address);
    await until(pupil, async () => Math.abs((await shownTime(pupil)) - time) < 1e-3, "the same time");
    assert.notEqual(await sessionOf(pupil), id);
    await pupil.keyboard.press("r");
    await until(pupil, async () => (await shownTime(pupil)) === 0, "its own run is at the start");
  });
  assert.equal((await session(id)).time, time);
  // As well in another tab that this one opens, with a copy of its storage.
  const [tab] = await Promise.all([page.waitForEvent("popup"), page.evaluate((to) => void window.open(to), address)]);
  await framed(tab);
  assert.notEqual(await sessionOf(tab), id);
  // And in a doubled tab, whose history is a copy, too: the first one still shows the session.
  await tab.evaluate((session) => {
    history.replaceState({ session }, "", location.href);
    sessionStorage.setItem("truestep-run", JSON.stringify({ session }));
  }, id);
  await tab.goto("about:blank");
  await tab.goBack();
  await until(tab, async () => ![id, null].includes(await sessionOf(tab)), "a session of its own");
  await tab.close();
  assert.equal((await session(id)).time, time);
});

test("who watches sees every frame, and can neither change nor end the run", async () => {
  const id = await own(spring);
  const { own: mine, watch } = await sharedLinks(page);
  assert.match(mine, /\/#s=/);
  assert.equal(watch, `${url}/?watch=${id}`);
  await page.click("#play");
  await paused(page);
  await elsewhere(async (pupil) => {
    await pupil.goto(watch);
    await framed(pupil);
    for (const control of ["#play", "#reset", "#step", "#speed"]) assert.ok(!(await pupil.locator(control).isVisible()), control);
    assert.ok(await pupil.locator("#watching").isVisible());
    const before = await session(id);
    const sent = [];
    pupil.on("request", (request) => request.method() !== "GET" && sent.push(`${request.method()} ${request.url()}`));
    for (const key of ["Space", ".", "Shift+.", "r", "[", "]"]) await pupil.keyboard.press(key);
    // All over the picture, so on the masses as well.
    for (let x = 300; x < 1000; x += 25) {
      await pupil.mouse.move(x, 400);
      await pupil.mouse.down();
      await pupil.mouse.move(x + 40, 350);
      await pupil.mouse.up();
    }
    await pupil.waitForTimeout(500);
    const after = await session(id);
    assert.deepEqual([after.step, after.status, after.time], [before.step, before.status, before.time]);
    assert.deepEqual(sent, []);
    // It follows.
    await ask(url, `/v1/sessions/${id}/step`, { steps: 100 });
    await until(pupil, async () => Math.abs((await shownTime(pupil)) - before.time - 1) < 1e-3, "a second later");
    await page.click("#play");
    await until(pupil, async () => (await shownTime(pupil)) > before.time + 1.5, "it plays there, too");
    assert.match(pupil.url(), /\?watch=/);
    // To take the scene is to have a run of one's own.
    await pupil.keyboard.press("e");
    await pupil.click("#create");
    await until(pupil, async () => (await sessionOf(pupil)) !== id && (await pupil.locator("#play").isVisible()), "its own run");
  });
  await page.waitForTimeout(500);
  assert.equal((await session(id)).status, "playing");
  assert.ok(!(await page.locator("#watching").isVisible()));
});

test("an address with ?session= shares the control, as requests of the service do", async () => {
  const id = await open(page, url, spring);
  await elsewhere(async (second) => {
    await second.goto(`${url}/?session=${id}`);
    await framed(second);
    await second.click("#step");
    await until(second, async () => (await session(id)).step === 1, "one step");
  });
});

test("another moment in the address of an open page is gone to in a new run", async () => {
  await page.goto(`${url}/?gallery=flag`);
  await until(page, async () => (await shownTime(page)) > 0.2, "it plays");
  const id = await sessionOf(page);
  await page.evaluate(() => (location.hash = "t=2"));
  await until(page, async () => Math.abs((await shownTime(page)) - 2) < 0.02 && (await sessionOf(page)) !== id, "a run at 2 s");
  await paused(page);
  assert.equal((await session(id)).status, 404);
});

test("a link that was cut off says so", async () => {
  await own(spring);
  const { own: whole } = await sharedLinks(page);
  await page.goto("about:blank");
  await page.goto(whole.replace(/&.*/, "").slice(0, -12));
  await until(page, async () => /not complete/.test(await page.textContent("#problems")), "a card says so");
  assert.ok(await page.locator("#gallery").isVisible());
});

test("the editor opens with a scene that runs, and it stops at its end, once", async () => {
  const id = await own(undefined);
  const { time: { duration } } = await (await fetch(`${url}/v1/sessions/${id}/scene`)).json();
  await page.selectOption("#speed", "5");
  await until(page, async () => (await shownTime(page)) > duration - 0.01, "it is at the end");
  await paused(page);
  assert.match(await page.textContent("#hint"), /the end of the scene, after 10 s/);
  assert.equal((await session(id)).status, "paused");
  await page.click("#play");
  await until(page, async () => (await shownTime(page)) > 1.3 * duration, "played again it goes on");
  // A page to which it was given lets it play: control.
  const { id: given } = await ask(url, "/v1/sessions", { ...spring, time: { dt: 0.01, duration: 1 } });
  await page.goto(`${url}/?session=${given}`);
  await framed(page);
  await page.click("#play");
  await until(page, async () => (await shownTime(page)) > 1.5, "it plays on");
});

test("only what was gone was written to the console as an error", () => assert.deepEqual(bad.filter((text) => !/status of 4(04|10)/.test(text)), []));
