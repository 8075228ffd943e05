// The pages for people who do not see them, or not all colours: axe-core finds nothing serious in any state of the viewer
// and of the studies, dark and light, wide and on a phone. Runs against the executable in TRUESTEP_BINARY.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import path from "node:path";
import { before, test } from "node:test";
import { need, web } from "./chromium.mjs";
import { until } from "./pixels.mjs";
import { page, url } from "./served.mjs";

const axe = path.join(web, "node_modules/axe-core/axe.min.js");

let script;

before(async () => {
  need(axe, "axe-core is missing: run npm ci in web/");
  script = readFileSync(axe, "utf8");
});

/** Serious and critical findings, one line each. */
async function findings() {
  await page.evaluate(script); // the page's policy allows no script of others
  const { violations } = await page.evaluate(() => axe.run(document, { resultTypes: ["violations"] }));
  return violations.filter(({ impact }) => ["serious", "critical"].includes(impact)).flatMap(({ id, nodes }) => nodes.map(({ target, any, all }) => `${id}: ${target.join(" ")}: ${[...any, ...all].map(({ message }) => message).join("; ")}`));
}

async function run() {
  await page.goto("about:blank");
  await page.goto(`${url}/?gallery=flag`);
  await until(page, async () => (await page.textContent("#read-frame")) !== "0", "a frame");
  await page.waitForSelector("#legend button");
}

const states = {
  "the gallery": async () => {
    await page.goto(url);
    await page.waitForSelector("#gallery [data-scene]");
  },
  "a run": run,
  "the links to share": async () => {
    await run();
    await page.click("#share summary");
  },
  "the choice of observables": async () => {
    await run();
    await page.click("#toggle-panel");
    if (await page.locator("#panel").isVisible()) await page.click("#toggle-panel");
    await page.click("#choose summary");
  },
  "an editor with a mistake": async () => {
    await run();
    await page.keyboard.press("e");
    await page.fill("#scene-text", '{"gravitty": 1}');
    await page.click("#validate");
    await page.waitForSelector("#findings .pointer");
  },
  "a card of a problem": async () => {
    await page.goto(`${url}/?session=00000000-0000-4000-8000-000000000000`);
    await page.waitForSelector("#problems .card");
    await page.waitForTimeout(400); // it fades in
  },
  "the help": async () => {
    await run();
    await page.click("#show-help");
  },
  "the studies": async () => {
    await page.goto(`${url}/studies.html?gallery=flag`);
    await page.waitForSelector("form");
  },
};

for (const [colorScheme, width, height] of [["dark", 1280, 800], ["light", 1280, 800], ["light", 390, 844]]) {
  for (const [name, open] of Object.entries(states)) {
    test(`${name}, ${colorScheme}, ${width} wide`, async () => {
      await page.emulateMedia({ colorScheme, reducedMotion: "reduce" });
      await page.setViewportSize({ width, height });
      await open();
      assert.deepEqual(await findings(), []);
    });
  }
}

test("a picture without a text and words that fade are found: the control", async () => {
  await page.goto(url);
  await page.evaluate(() => document.querySelector("#tab-gallery").insertAdjacentHTML("beforeend", '<img src="/favicon.svg"><span style="color: #777; background: #888">pale</span>'));
  const found = await findings();
  for (const id of ["image-alt", "color-contrast"]) assert.ok(found.some((line) => line.startsWith(id)), `${id}: ${found}`);
});
