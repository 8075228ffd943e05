// What the browser tests share: the real server on a free port, Debian's Chromium, and a page whose console
// errors are kept.
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

export const web = path.join(path.dirname(fileURLToPath(import.meta.url)), "..", "..", "web");
// Against hangs only: software rendering on a busy machine (TRUESTEP_SLOWDOWN, tests/slowdown.py).
export const patience = 8_000 * Math.max(4, Number(process.env.TRUESTEP_SLOWDOWN ?? 4));
const chromiumPath = process.env.CHROMIUM ?? "/usr/bin/chromium";

export function need(file, sentence) {
  if (!existsSync(file)) throw new Error(sentence);
}

/** Starts the executable and reads the address that it prints; {url, stop}. */
export function serveBinary(binary) {
  need(binary, `no executable at ${binary}: build the target truestep`);
  const data = mkdtempSync(path.join(tmpdir(), "truestep-browser-"));
  const child = spawn(binary, ["serve", "--port", "0", "--data-dir", data], { stdio: ["ignore", "pipe", "pipe"] });
  const stop = async () => {
    const gone = new Promise((resolve) => child.once("exit", resolve));
    child.kill("SIGTERM");
    await gone;
    rmSync(data, { recursive: true, force: true });
  };
  return new Promise((resolve, reject) => {
    let printed = "";
    const read = (chunk) => {
      printed += chunk;
      const found = /http:\/\/[\w.[\]]+:\d+/.exec(printed);
      if (found) resolve({ url: found[0], stop });
    };
    child.stdout.on("data", read);
    child.stderr.on("data", read);
    child.once("exit", (code) => reject(new Error(`the server ended with ${code}:\n${printed}`)));
  });
}

/** {browser, page, bad}: `bad` grows by every console error and uncaught exception. */
export async function openChromium() {
  need(path.join(web, "node_modules/playwright-core"), "playwright-core is missing: run npm ci in web/");
  need(chromiumPath, `no Chromium at ${chromiumPath}: install Debian's chromium or set CHROMIUM`);
  const { chromium } = await import(pathToFileURL(path.join(web, "node_modules/playwright-core/index.mjs")));
  const browser = await chromium.launch({
    executablePath: chromiumPath,
    args: [
      "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
      "--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    ],
  });
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 }, colorScheme: "dark" });
  page.setDefaultTimeout(patience);
  const bad = [];
  // A network interface that comes or goes on the machine aborts requests; the page asks again.
  page.on("console", (message) => message.type() === "error" && !/ERR_NETWORK_CHANGED/.test(message.text()) && bad.push(message.text()));
  page.on("pageerror", (error) => bad.push(String(error)));
  return { browser, page, bad };
}
