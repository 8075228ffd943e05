// A person's way through the page of studies in Chromium: choose a scene, start, see the progress, read plot and
// table, make a mistake, cancel. Runs against the executable in TRUESTEP_BINARY, or against a running service in
// TRUESTEP_URL.
import assert from "node:assert/strict";
import { patience } from "./chromium.mjs";
import { bad, page, step, url } from "./served.mjs";

const measured = 3 * patience; // a study with a budget of 2 s of CPU, on a busy machine

step("the gallery leads to the studies of a scene", async () => {
  await page.goto(url);
  await page.hover('#gallery article[data-scene="terminal_velocity"]');
  await page.click('#gallery article[data-scene="terminal_velocity"] .study');
  await page.waitForSelector("#kinds input:checked");
  assert.equal(await page.inputValue("#scene"), "terminal_velocity");
  assert.equal(await page.inputValue("#kinds input:checked"), "work_precision");
  assert.equal(await page.locator("#result").isVisible(), false);
});

step("only the useful parameters are shown at first", async () => {
  await page.waitForSelector("#fields [data-pointer='/budget'] input");
  assert.equal(await page.locator("[data-pointer='/horizon'] input").isVisible(), true);
  assert.equal(await page.locator("[data-pointer='/samples'] input").isVisible(), false);
  await page.click("#fields summary");
  assert.equal(await page.locator("[data-pointer='/samples'] input").isVisible(), true);
  // Every field has a name that can be read out.
  const unnamed = await page.$$eval("#study-form input, #study-form select", (inputs) => inputs.filter((input) => input.labels.length === 0).length);
  assert.equal(unnamed, 0);
});

step("a study of run time against error ends with a plot, sentences and a table", async () => {
  await page.fill("[data-pointer='/budget'] input", "2");
  await page.click("#start");
  await page.waitForSelector("#progress, #result:not([hidden])");
  await page.waitForSelector(".chart [data-curve] circle", { timeout: measured });
  assert.match(page.url(), /[?&]operation=/);
  const curves = await page.$$eval(".chart [data-curve]", (groups) => groups.map((group) => group.dataset.curve));
  assert.ok(curves.includes("rk4") && curves.length >= 5, curves.join());
  const rows = await page.$$eval("#rows tbody tr", (lines) => lines.map((line) => line.cells[0].textContent));
  assert.ok(rows.length >= 20, `${rows.length} rows`);
  assert.deepEqual(curves.filter((name) => !rows.includes(name)), [], "every curve is in the table");
  assert.ok((await page.locator(".winners tbody tr").count()) >= 2);
  assert.match(await page.textContent(".how"), /checked by/);
});

step("the point under the mouse is read out, and nothing is where no point is", async () => {
  const dot = await page.locator(".chart .front circle").first().boundingBox();
  await page.mouse.move(dot.x + dot.width / 2, dot.y + dot.height / 2);
  assert.match(await page.textContent(".figure-readout"), /CPU time.*\d [nµm]?s/);
  await page.mouse.move(5, 5);
  assert.equal(await page.locator(".figure-readout").isVisible(), false);
});

step("a column sorts, both ways", async () => {
  const first = async () => page.textContent("#rows tbody tr:first-child td:first-child");
  const before = await first();
  await page.click("#rows th:first-child button");
  await page.click("#rows th:first-child button");
  assert.equal(await page.getAttribute("#rows th:first-child", "aria-sort"), "descending");
  assert.notEqual(await first(), before);
});

step("the three downloads have something in them", async () => {
  const links = await page.$$eval(".result-head nav a", (anchors) => anchors.map((anchor) => anchor.href));
  assert.equal(links.length, 3);
  for (const link of links) {
    const response = await page.request.get(link);
    assert.equal(response.status(), 200, link);
    assert.ok((await response.text()).length > 500, link);
  }
});

step("a reload shows the same study", async () => {
  const lines = await page.locator("#rows tbody tr").count();
  await page.reload();
  await page.waitForSelector("#rows tbody tr");
  assert.equal(await page.locator("#rows tbody tr").count(), lines);
});

step("nothing was written to the console as an error so far", () => assert.deepEqual(bad, []));

step("a mistake becomes a card, and its field is marked", async () => {
  await page.fill("[data-pointer='/horizon'] input", "-3");
  await page.click("#start");
  await page.waitForSelector("#problems .card");
  assert.match(await page.textContent("#problems .card"), /\/horizon/);
  assert.equal(await page.getAttribute("[data-pointer='/horizon'] input", "aria-invalid"), "true");
  assert.equal(await page.locator("#start").isEnabled(), true);
  await page.click("#problems .card button");
  await page.fill("[data-pointer='/horizon'] input", "");
});

step("a running study can be cancelled", async () => {
  await page.selectOption("#scene", "attractors");
  await page.fill("[data-pointer='/budget'] input", "60");
  await page.click("#start");
  await page.click("#cancel");
  await page.waitForSelector("#empty:not([hidden])", { timeout: measured });
  assert.equal(await page.locator("#start").isEnabled(), true);
});

step("an adaptive method's error is shown over its tolerance, with its own steps", async () => {
  await page.goto(`${url}/studies.html?gallery=lotka_volterra&kind=convergence`);
  await page.waitForSelector("#fields [data-pointer='/budget'] input");
  await page.fill("[data-pointer='/budget'] input", "2");
  await page.click("#start");
  await page.waitForSelector("#rows tbody tr", { timeout: measured });
  const heads = await page.$$eval("#rows th", (cells) => cells.map((cell) => cell.textContent.trim()));
  assert.equal(heads[0], "tolerance");
  assert.ok(heads.includes("steps"), heads.join());
  // More steps than the session has are the method's own; no step of a nanosecond is anywhere.
  assert.doesNotMatch(await page.textContent("#result"), /\d ns/);
  const errors = await page.$$eval(".chart .grid text", (texts) => texts.map((text) => text.textContent));
  assert.ok(!errors.some((text) => /10[²³⁴-⁹]/.test(text)), errors.join());
  assert.equal((await page.$$(".chart .dashed")).length, 0);
});

step("a scene that cannot be studied says why, and the button covers nothing", async () => {
  await page.goto(`${url}/studies.html?gallery=pyramid_2d`);
  await page.waitForSelector("#not-offered:not([hidden])");
  assert.match(await page.textContent("#not-offered"), /rigid2d has a solver of its own/);
  assert.equal(await page.locator("#start").isEnabled(), false);
  await page.click('.kind:has(input[value="sweep"])');
  await page.waitForSelector("#not-offered", { state: "hidden" });
  assert.equal(await page.locator("#start").isEnabled(), true);
  await page.selectOption("#scene", "lotka_volterra");
  await page.click('.kind:has(input[value="work_precision"])');
  await page.waitForSelector("#fields [data-pointer='/budget'] input");
  const boxes = await page.evaluate(() => {
    const box = (selector) => document.querySelector(selector).getBoundingClientRect();
    return { body: box(".form-body").bottom, actions: box(".studies .actions").top, bottom: box(".studies .actions").bottom, window: innerHeight };
  });
  assert.ok(boxes.body <= boxes.actions + 0.5 && boxes.bottom <= boxes.window, JSON.stringify(boxes));
});

step("a narrow window has no sideways scrolling", async () => {
  await page.setViewportSize({ width: 390, height: 800 });
  await page.waitForSelector("#start");
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 390);
  const box = await page.locator("#start").boundingBox();
  assert.ok(box.x >= 0 && box.x + box.width <= 390);
});

step("only the refused request was written to the console as an error", () => {
  assert.deepEqual(bad.filter((text) => !/status of 422/.test(text)), []);
});
