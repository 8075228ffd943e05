// A person's way through the viewer in Chromium: load, pick a scene, see it move, pause, pull a point, make a
// mistake in a scene, reset. Runs against the executable in TRUESTEP_BINARY, or against a running service in TRUESTEP_URL.
// Every check that something changes has a control in which it must not.
import assert from "node:assert/strict";
import { patience } from "./chromium.mjs";
import { bad, page, step, url } from "./served.mjs";

const number = async (id) => Number((await page.textContent(id)).replace(/[^\d.]/g, ""));

async function until(condition, what) {
  const end = Date.now() + patience;
  while (!(await condition())) {
    if (Date.now() > end) assert.fail(`timed out: ${what}`);
    await page.waitForTimeout(100);
  }
}

/** The picture without what floats over it. */
async function picture() {
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  return page.screenshot({ clip: { x: 380, y: 80, width: 560, height: 600 } });
}

const playing = async () => (await page.getAttribute("#play", "aria-label")) === "Pause";

step("the gallery shows its scenes, and picking one plays it", async () => {
  await page.goto(url);
  await page.waitForSelector("#gallery [data-scene]");
  const names = await page.$$eval("#gallery article", (cards) => cards.map((card) => card.dataset.scene));
  assert.ok(names.length >= 3, names.join());
  const scene = names.find((name) => /hanging_cloth/.test(name)) ?? names.find((name) => /cloth/.test(name)) ?? names[0];
  await page.click(`#gallery .run[data-scene="${scene}"]`);
  await until(async () => (await page.getAttribute("#connection", "data-state")) === "open", "connected");
  await until(async () => (await number("#read-frame")) >= 3, "frames arrive");
  // The address says how to make the run, and names nobody's session.
  await until(() => new URL(page.url()).searchParams.get("gallery") === scene, "the scene's name is in the address");
  assert.doesNotMatch(page.url(), /session=/);
  await until(playing, "it plays");
});

step("frame number, time and picture change while it plays, and stand still when paused", async () => {
  const frame = await number("#read-frame");
  const first = await picture();
  await until(async () => (await number("#read-frame")) > frame + 2, "the frame number grows");
  assert.ok((await number("#read-time")) > 0);
  await until(async () => !first.equals(await picture()), "the picture changes");

  await page.keyboard.press("Space");
  await until(async () => !(await playing()), "paused");
  // What was on its way when the key was pressed still arrives.
  let step = -1;
  await until(async () => {
    const last = step;
    step = await number("#read-step");
    await page.waitForTimeout(700);
    return step === last;
  }, "the last frame is shown");
  const still = await picture();
  await page.waitForTimeout(1000);
  assert.equal(await number("#read-step"), step);
  assert.ok(still.equals(await picture()), "a paused picture stands still");
});

step("one step is one step", async () => {
  const step = await number("#read-step");
  await page.click("#step");
  await until(async () => (await number("#read-step")) === step + 1, "one step more");
});

step("the energy plot has series with values", async () => {
  await page.waitForSelector("#energy:not([hidden]) canvas");
  assert.ok((await page.$$("#legend button")).length >= 1);
  assert.match(await page.textContent("#legend button b"), /\d/);
});

const place = async () => (await page.textContent("#probe span")).trim().split(/\s+/).map(Number);

/** Goes back to the start, and the mouse over a point of the lower part: what hangs is held at the top. */
async function overAPoint() {
  await page.mouse.move(5, 5);
  if (await playing()) await page.keyboard.press("Space");
  await until(async () => !(await playing()), "paused");
  await page.click("#reset");
  await until(async () => (await number("#read-step")) === 0, "back at the start");
  const box = await page.locator("#view").boundingBox();
  // The viewer looks 14 pixels far.
  for (let y = 640; y > 100; y -= 18) {
    for (let x = 400; x < 900; x += 18) {
      await page.mouse.move(box.x + x, box.y + y);
      if (await page.$eval("#probe", (probe) => !probe.hidden)) return { x: box.x + x, y: box.y + y };
    }
  }
  assert.fail("no point under the mouse anywhere");
}

/** Presses on the point at `at`, plays, and pulls it up by 200 pixels; the mouse stays down. */
async function pullUp(at) {
  await page.mouse.move(at.x, at.y);
  await page.mouse.down();
  await page.keyboard.press("Space");
  await until(playing, "playing again");
  await page.mouse.move(at.x, at.y - 60, { steps: 4 });
  await page.mouse.move(at.x, at.y - 200, { steps: 6 });
}

async function letGo() {
  await page.mouse.up();
  await page.mouse.move(5, 5);
  await until(async () => !(await page.locator("#probe").isVisible()), "the mark goes");
}

step("a point follows the mouse", async () => {
  const at = await overAPoint();
  const name = await page.textContent("#probe b");
  const [, before] = await place();
  await pullUp(at);
  // The point would fall or stay; a pull of 200 pixels lifts it by far more than 5 cm.
  await until(async () => (await place())[1] > before + 0.05, `${name} rises from ${before}`);
  assert.equal(await page.textContent("#probe b"), name);
  await letGo();
});

step("a double click pins a point, and another one sets it free", async () => {
  const at = await overAPoint();
  const name = await page.textContent("#probe b");
  const before = await place();
  await page.mouse.dblclick(at.x, at.y);
  await until(async () => /pinned$/.test(await page.textContent("#hint")), "it says that the point is pinned");
  await pullUp(at);
  const step = await number("#read-step");
  await until(async () => (await number("#read-step")) > step + 30, "steps with the pull");
  assert.deepEqual(await place(), before, `${name} stays where it is pinned`);
  await letGo();

  // The control is the same point, free again: it does not stay.
  const again = await overAPoint();
  assert.deepEqual(again, at);
  await page.mouse.dblclick(at.x, at.y);
  await until(async () => /pinned$/.test(await page.textContent("#hint")), "pinned again after the reset");
  await page.waitForTimeout(400); // a third click within the double click's time would be one of it
  await page.mouse.dblclick(at.x, at.y);
  await until(async () => /free$/.test(await page.textContent("#hint")), "it says that the point is free");
  await pullUp(at);
  await until(async () => (await place())[1] > before[1] + 0.05, `${name} rises when it is free`);
  await letGo();
});

step("reset goes back to step 0", async () => {
  await page.keyboard.press("Space");
  await until(async () => !(await playing()), "paused");
  await page.click("#reset");
  await until(async () => (await number("#read-step")) === 0, "back at the start");
});

step("nothing was written to the console as an error so far", () => assert.deepEqual(bad, []));

step("a scene with a mistake names its pointer in the editor, and a click shows the place", async () => {
  await page.click("#toggle-panel");
  if (!(await page.locator("#tab-editor").isVisible())) await page.click("#toggle-panel");
  await page.click("#tab-editor");
  const scene = JSON.parse(await page.inputValue("#scene-text"));
  scene.gravitty = [0, 1, 0];
  await page.fill("#scene-text", JSON.stringify(scene, null, 2));
  await page.click("#create");
  const pointer = page.locator("#findings .pointer", { hasText: "/gravitty" });
  await pointer.waitFor();
  await pointer.click();
  const selected = await page.$eval("#scene-text", (text) => text.value.slice(text.selectionStart, text.selectionEnd));
  assert.match(selected, /^"gravitty"/);
  assert.ok((await page.$$("#gutter .marked")).length >= 1);
});

step("what the service refuses becomes a card that can be read and closed", async () => {
  await page.goto(`${url}/?session=00000000-0000-4000-8000-000000000000`);
  const card = page.locator("#problems .card");
  await card.waitFor();
  assert.match(await card.textContent(), /session/i);
  await card.locator("button").click();
  assert.equal(await card.count(), 0);
});

step("a narrow window keeps its buttons inside", async () => {
  await page.setViewportSize({ width: 390, height: 844 });
  await page.goto(url);
  await page.waitForSelector("#gallery [data-scene]");
  await page.click("#gallery .run");
  await until(async () => (await number("#read-frame")) >= 1, "frames arrive");
  const buttons = ["#play", "#reset", "#step", "#camera", "#views", "#toggle-panel", "#show-help", "#theme"];
  const boxes = [];
  for (const id of buttons) {
    const box = await page.locator(id).boundingBox();
    assert.ok(box && box.x >= 0 && box.x + box.width <= 390 && box.y + box.height <= 844, `${id} ${JSON.stringify(box)}`);
    boxes.push(box);
  }
  // The title is beside the buttons of the top line, not under them.
  const title = await page.locator("#title").boundingBox();
  for (const box of boxes.filter(({ y }) => y < 60)) assert.ok(box.x + box.width <= title.x + 1 || title.x + title.width <= box.x + 1, JSON.stringify([title, box]));
});

step("only refused requests were written to the console as errors", () => {
  assert.deepEqual(bad.filter((text) => !/status of 4(04|22)/.test(text)), []);
});
