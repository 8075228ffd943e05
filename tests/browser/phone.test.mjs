// A phone held upright: every control of a scene is reached by a finger, and so is what the scene is about; and the
// system's choice of light or dark is followed until another is made. Runs against the executable in TRUESTEP_BINARY.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import { ask, until } from "./pixels.mjs";
import { bad, page, url } from "./served.mjs";

before(async () => {
  await page.setViewportSize({ width: 390, height: 844 });
});

const kFinger = 44; // CSS pixels

/** Everything that can be pressed: name, box, and whether its middle is covered by something else. */
const targets = () => page.$$eval("button, a[href], summary, input:not([type=checkbox]), select", (all) => all.filter((one) => one.checkVisibility({ visibilityProperty: true })).map((one) => {
  const { x, y, width, height } = one.getBoundingClientRect();
  const hit = document.elementFromPoint(x + width / 2, y + height / 2);
  return { name: one.id || one.className || one.textContent, x, y, width, height, inside: Boolean(hit) && (one.contains(hit) || hit.contains(one)) };
}));

async function shown(name) {
  await page.goto(`${url}/?gallery=${name}`);
  await until(page, async () => (await page.textContent("#read-frame")) !== "0", "a frame");
}

// Bodies and springs, springs alone, plots, grids, particles: they differ in their switches.
for (const name of ["wrecking_ball", "flag", "robertson", "heat_plate", "fountain"]) {
  test(`${name}: targets are as large as a finger, on the screen and free`, async () => {
    await shown(name);
    for (const { name: what, x, y, width, height, inside } of await targets()) {
      assert.ok(width >= kFinger && height >= kFinger, `${what}: ${width} x ${height}`);
      if (await page.$eval("#legend", (legend, [left, top]) => top > legend.getBoundingClientRect().top - 1 && top < legend.getBoundingClientRect().bottom && left > 0, [x, y])) continue; // that row scrolls
      assert.ok(x >= 0 && x + width <= 390 && y >= 0 && y + height <= 844, `${what}: ${JSON.stringify({ x, y, width, height })}`);
      assert.ok(inside, `${what} is covered`);
    }
  });
}

test("the switches of contacts and joints are pressed by a finger", async () => {
  await shown("wrecking_ball");
  for (const id of ["#show-contacts", "#show-joints", "#show-lines"]) {
    const before = await page.getAttribute(id, "aria-pressed");
    await page.click(id);
    assert.notEqual(await page.getAttribute(id, "aria-pressed"), before, id);
  }
});

test("what the scene is about is shown on request, with the measurements hidden as well", async () => {
  assert.ok(!(await page.locator("#lesson").isVisible()));
  await page.click("#show-lesson");
  assert.ok(await page.locator("#lesson").isVisible());
  const { y, height } = await page.locator("#lesson").boundingBox();
  assert.ok(y > 56 && y + height < (await page.locator("#transport").boundingBox()).y);
  await page.click("#show-side");
  assert.ok(!(await page.locator("#lesson").isVisible()));
  await page.click("#show-lesson");
  assert.ok(await page.locator("#lesson").isVisible());
  await page.click("#show-lesson");
  assert.ok(!(await page.locator("#lesson").isVisible()) && (await page.locator("#readout").isVisible()));
  // The control: a scene that says nothing of itself has no such switch.
  const { id } = await ask(url, "/v1/sessions", { time: { dt: 0.01 }, systems: [{ type: "particles", id: "p", positions: [[0, 0, 0]] }] });
  await page.goto(`${url}/?session=${id}`);
  await until(page, async () => page.locator("#transport").isVisible(), "controls");
  assert.ok(!(await page.locator("#show-lesson").isVisible()));
});

test("gallery, editor, links and help are used by a finger, too", async () => {
  await shown("flag");
  const large = async (what) => {
    for (const { name, width, height } of await targets()) assert.ok(width >= kFinger && height >= kFinger, `${what}, ${name}: ${width} x ${height}`);
  };
  await page.click("#share summary");
  await large("links");
  await page.click("#share summary");
  await page.click("#show-help");
  await large("help");
  await page.click("#help button");
  await page.click("#toggle-panel");
  await large("gallery");
  await page.click("#tab-editor");
  await page.fill("#scene-text", '{"gravitty": 1}');
  await page.click("#validate");
  await page.waitForSelector("#findings .pointer");
  await large("editor");
});

const theme = () => page.evaluate(() => document.documentElement.dataset.theme);

test("light or dark as the system has it, until one is chosen", async () => {
  await page.emulateMedia({ colorScheme: "light" });
  await page.goto(url);
  assert.equal(await theme(), "light");
  await page.emulateMedia({ colorScheme: "dark" });
  await until(page, async () => (await theme()) === "dark", "it follows at once");
  await page.emulateMedia({ colorScheme: "light" });
  await page.goto(`${url}/studies.html`);
  assert.equal(await theme(), "light");
  await page.goto(url);
  await page.keyboard.press("l");
  assert.equal(await theme(), "dark");
  await page.reload();
  assert.equal(await theme(), "dark", "a choice is kept");
  await page.emulateMedia({ colorScheme: "dark" });
  await page.emulateMedia({ colorScheme: "light" });
  await page.waitForTimeout(200);
  assert.equal(await theme(), "dark", "and the system does not change it");
});

test("only a refused scene was written to the console as an error", () => assert.deepEqual(bad.filter((text) => !/status of 422/.test(text)), []));
