// What tests of pictures share: the pixels of a screenshot, and a session that is opened in the page.
import assert from "node:assert/strict";
import { patience } from "./chromium.mjs";

/** Waits until `condition` holds. */
export async function until(page, condition, what) {
  const end = Date.now() + patience;
  while (!(await condition())) {
    if (Date.now() > end) assert.fail(`timed out: ${what}`);
    await page.waitForTimeout(100);
  }
}

const middle = { x: 300, y: 100, width: 680, height: 560 };

/** Waits until the picture of a paused scene stands still: keys, cameras and bodies on their way need no fixed time. */
export async function settled(page, clip = middle) {
  let last = Buffer.alloc(0);
  await until(page, async () => {
    const before = last;
    await page.waitForTimeout(300);
    last = await page.screenshot({ clip });
    return last.equals(before);
  }, "the picture stands still");
}

/** The pixels of a part of the page: {width, height, at(x, y) -> [r, g, b]}, coordinates of the page. */
export async function pixels(page, clip) {
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  const png = (await page.screenshot({ clip })).toString("base64");
  const { width, height, coded } = await page.evaluate(async (text) => {
    const image = new Image();
    image.src = `data:image/png;base64,${text}`;
    await image.decode();
    const canvas = Object.assign(document.createElement("canvas"), { width: image.width, height: image.height });
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const all = context.getImageData(0, 0, image.width, image.height).data;
    const coded = await new Promise((resolve) => {
      const reader = new FileReader();
      reader.onload = () => resolve(reader.result.split(",")[1]);
      reader.readAsDataURL(new Blob([all]));
    });
    return { width: image.width, height: image.height, coded };
  }, png);
  const data = Buffer.from(coded, "base64");
  const at = (x, y) => [0, 1, 2].map((c) => data[4 * (Math.round(y - clip.y) * width + Math.round(x - clip.x)) + c]);
  /** Places whose colour `wanted` accepts. */
  const where = (wanted) => {
    const found = [];
    for (let y = 0; y < height; ++y) for (let x = 0; x < width; ++x) if (wanted(...at(x + clip.x, y + clip.y))) found.push([x + clip.x, y + clip.y]);
    return found;
  };
  return { width, height, at, where };
}

/** The answer to a POST of `body`. */
export async function ask(url, path, body) {
  const response = await fetch(url + path, { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(body) });
  const answer = await response.json();
  assert.ok(response.ok, JSON.stringify(answer));
  return answer;
}

/** The session that the page shows; its address names only those that were given to it. */
export const sessionOf = (page) => page.evaluate(() => history.state?.session ?? new URL(location.href).searchParams.get("session"));

/** Opens a paused session of `scene` in the page; its id. */
export async function open(page, url, scene, { bare = true } = {}) {
  const { id } = await ask(url, "/v1/sessions", scene);
  await page.goto(`${url}/?session=${id}`);
  await until(page, async () => (await page.textContent("#read-frame")) !== "0", "a frame is shown");
  if (bare && (await page.$eval("#side", (side) => !side.hidden))) await page.keyboard.press("m");
  return id;
}
