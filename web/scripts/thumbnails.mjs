// Makes public/thumbnails ahead: of each scene of the gallery the moment at which its picture shows most (the largest
// PNG of several through the run), as WebP. Needs a running service and Debian's Chromium:
//   node scripts/thumbnails.mjs http://127.0.0.1:8080 [NAME...]
import { mkdirSync, writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import path from "node:path";
import { chromium } from "playwright-core";

const [url = "http://127.0.0.1:8080", ...names] = process.argv.slice(2);
const out = path.join(path.dirname(path.dirname(fileURLToPath(import.meta.url))), "public", "thumbnails");
const kShares = [0.08, 0.2, 0.35, 0.55, 0.8];
const kLongest = 10; // s of a scene that moves in real time
const kPatience = 6000; // ms for a scene's steps

mkdirSync(out, { recursive: true });
const post = async (where, body) => {
  const response = await fetch(url + where, { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(body) });
  if (!response.ok) throw new Error(await response.text());
  return response.json();
};
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox"] });
const page = await browser.newPage();
const { scenes } = await (await fetch(`${url}/v1/gallery`)).json();
for (const { name } of scenes) {
  if (names.length > 0 && !names.includes(name)) continue;
  const { id } = await post("/v1/sessions", { gallery: name });
  const scene = await (await fetch(`${url}/v1/sessions/${id}/scene`)).json();
  const { duration = kLongest, dt } = scene.time;
  // Plots are seen as a whole at their end.
  const plot = scene.systems.every((system) => system.type === "ode" && !system.tracers);
  const whole = plot || duration / dt < 600 ? duration : Math.min(duration, kLongest);
  let best;
  const begun = Date.now();
  for (const share of plot ? [0.98] : kShares) {
    if (best && Date.now() - begun > kPatience) break;
    await post(`/v1/sessions/${id}/step`, { until: share * whole }).catch(() => undefined);
    const png = Buffer.from(await (await fetch(`${url}/v1/sessions/${id}/picture.png?width=400&height=254`)).arrayBuffer());
    if (!best || png.length > 1.03 * best.length) best = png;
  }
  await fetch(`${url}/v1/sessions/${id}`, { method: "DELETE" });
  const webp = await page.evaluate(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const canvas = Object.assign(document.createElement("canvas"), { width: image.width, height: image.height });
    canvas.getContext("2d").drawImage(image, 0, 0);
    return canvas.toDataURL("image/webp", 0.8).split(",")[1];
  }, best.toString("base64"));
  writeFileSync(path.join(out, `${name}.webp`), Buffer.from(webp, "base64"));
  console.log(name, Math.round((0.75 * webp.length) / 1024), "kB");
}
await browser.close();
