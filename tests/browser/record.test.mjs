// A run is recorded from the page: one button begins and ends it, and what was recorded is saved as a file. And on a tablet every
// control is as large as a finger, as on a phone. Runs against the executable in TRUESTEP_BINARY.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";
import { until } from "./pixels.mjs";
import { bad, browser, expected, page, step, url } from "./served.mjs";

const recordings = async () => (await (await fetch(`${url}/v1/recordings`)).json()).recordings;
const recorded = () => page.getAttribute("#record", "aria-pressed");

step("a recording begins", async () => {
  await page.goto(`${url}/?gallery=flag`);
  await until(page, async () => (await page.textContent("#read-frame")) !== "0", "a frame");
  assert.equal(await recorded(), "false");
  assert.deepEqual(await recordings(), [], "the control: nothing is recorded before");
  await page.click("#record");
  await until(page, async () => (await recorded()) === "true", "the button is pressed");
  await until(page, async () => (await recordings())[0]?.frames > 0, "frames are recorded");
});

step("the page that comes back knows of it", async () => {
  await page.reload();
  await until(page, async () => (await recorded()) === "true", "the button is pressed");
});

step("it ends, and the file is saved", async () => {
  const saved = page.waitForEvent("download");
  await page.click("#record");
  const download = await saved;
  assert.match(download.suggestedFilename(), /\.vtkhdf$/);
  const bytes = await readFile(await download.path());
  assert.equal(bytes.subarray(1, 4).toString(), "HDF");
  assert.equal(await recorded(), "false");
  const [{ state, frames }] = await recordings();
  assert.equal(state, "finished");
  assert.ok(frames > 0);
});

step("who watches has no such button", async () => {
  const { id } = await (await fetch(`${url}/v1/sessions`, { method: "POST", headers: { "content-type": "application/json" }, body: '{"gallery": "flag"}' })).json();
  await page.goto(`${url}/?watch=${id}`);
  await until(page, () => page.locator("#watching").isVisible(), "it is watched");
  assert.ok(!(await page.locator("#record").isVisible()));
});

test("targets on a tablet are as large as a finger", async () => {
  const context = await browser.newContext({ viewport: { width: 1024, height: 768 }, hasTouch: true, isMobile: true });
  const tablet = await context.newPage();
  await tablet.goto(`${url}/?gallery=wrecking_ball`);
  await until(tablet, async () => (await tablet.textContent("#read-frame")) !== "0", "a frame");
  for (const panel of ["none", "gallery"]) {
    if (panel === "gallery") await tablet.click("#toggle-panel");
    const small = await tablet.$$eval(".transport button, .transport summary, .transport select, .top button, .top summary, .top a, .tabs button", (all) => all.filter((one) => one.checkVisibility({ visibilityProperty: true })).flatMap((one) => {
      const { x, y, width, height } = one.getBoundingClientRect();
      return width >= 44 && height >= 44 && x >= 0 && x + width <= innerWidth && y >= 0 && y + height <= innerHeight ? [] : [`${one.id || one.className}: ${width} x ${height} at ${x}, ${y}`];
    }));
    assert.deepEqual(small, [], panel);
  }
  await context.close();
});

test("nothing was written to the console as an error", () => {
  expected(/net::ERR_ABORTED/);
  assert.deepEqual(bad, []);
});
