// What the viewer costs: size of the bundle as it travels, time from the address to the first picture, pictures
// a second and processor time per picture with large scenes. Prints one JSON line per figure.
//   node scripts/measure.mjs URL     of a running service
// The service's own work is not in cpu_ms_per_picture; drawing is, for Chromium draws in software here.
import { readFileSync, readdirSync } from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
import { chromium } from "playwright-core";

const web = path.dirname(path.dirname(fileURLToPath(import.meta.url)));
const dist = path.join(web, "dist");
const say = (metric, ours, unit, more = {}) => console.log(JSON.stringify({ bench: "viewer", metric, ours, unit, ...more }));

const files = readdirSync(dist, { recursive: true }).filter((name) => /\.(html|js|css|svg)$/.test(name));
say("bundle", files.reduce((sum, name) => sum + gzipSync(readFileSync(path.join(dist, name)), { level: 9 }).length, 0) / 1024, "KiB gzip");

/** User and system time of a process and its descendants, s. */
function cpuOf(root) {
  const rows = readdirSync("/proc").filter((name) => /^\d+$/.test(name)).flatMap((pid) => {
    try {
      const fields = readFileSync(`/proc/${pid}/stat`, "utf8").replace(/^.*\) /, "").split(" ");
      return [{ pid: Number(pid), parent: Number(fields[1]), ticks: Number(fields[11]) + Number(fields[12]) }];
    } catch {
      return []; // ended meanwhile
    }
  });
  const inside = new Set([root]);
  for (let grown = true; grown; ) {
    grown = false;
    for (const row of rows) if (inside.has(row.parent) && !inside.has(row.pid)) inside.add(row.pid), (grown = true);
  }
  return rows.filter((row) => inside.has(row.pid)).reduce((sum, row) => sum + row.ticks, 0) / 100;
}

const url = process.argv[2];
if (!url) throw new Error("usage: node scripts/measure.mjs URL");
const scenes = {
  "100,000 particles": {
    time: { dt: 1 / 60, duration: 100 },
    systems: [{ type: "particles", id: "drops", fill: [{ shape: "box", arrangement: "random", center: [0, 1.5, 0], half_extents: [1.5, 1, 1.5], count: 100000, speed_spread: 1 }], gravity: [0, 0, 0], draw_radius: 0.012 }],
  },
  "cloth of 100 x 100": {
    time: { dt: 1 / 60, duration: 100 },
    systems: [{ type: "mass_spring", id: "cloth", cloth_grid: { origin: [-1, 2, 0], edge_u: [2, 0, 0], edge_v: [0, 0, 2], nx: 100, ny: 100 }, density: 0.2, stiffness: 100, shear_stiffness: 30, pins: [0, 99], integrator: "linear_implicit_euler" }],
  },
};

async function create(scene) {
  const ask = (path, body) => fetch(url + path, { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(body) });
  const response = await ask("/v1/sessions", scene);
  const session = await response.json();
  if (!response.ok) throw new Error(JSON.stringify(session));
  await ask(`/v1/sessions/${session.id}/play`, { speed: 1 });
  return session;
}

const server = await chromium.launchServer({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: [
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
  ],
});
const browser = await chromium.connect(server.wsEndpoint());
for (const [scene, document] of Object.entries(scenes)) {
  const session = await create({ schema_version: "1.0", name: scene, ...document });
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  await page.goto(`${url}/?session=${session.id}`);
  await page.waitForFunction(() => performance.getEntriesByName("first-picture").length > 0, undefined, { timeout: 60000 });
  say("first_picture", await page.evaluate(() => performance.getEntriesByName("first-picture")[0].startTime), "ms", { scene });
  await page.waitForTimeout(6000);
  const count = () => page.evaluate(() => performance.getEntriesByName("picture").length);
  const [before, cpu] = [await count(), cpuOf(server.process().pid)];
  const start = performance.now();
  await page.waitForTimeout(8000);
  const pictures = (await count()) - before;
  const seconds = (performance.now() - start) / 1000;
  const size = await page.$eval("#view", (canvas) => `${canvas.width}x${canvas.height}`);
  say("pictures_per_second", pictures / seconds, "1/s", { scene, size });
  say("cpu_per_picture", (1000 * (cpuOf(server.process().pid) - cpu)) / pictures, "ms", { scene, size });
  await page.close();
  await fetch(`${url}/v1/sessions/${session.id}`, { method: "DELETE" });
}
await browser.close();
await server.close();
