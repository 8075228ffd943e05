// What browser tests begin with: the executable in TRUESTEP_BINARY serves (or a running service in TRUESTEP_URL is used), and
// Chromium shows a page. All of it is there before the first line of the file that imports it.
import { after, test } from "node:test";
import { openChromium, serveBinary } from "./chromium.mjs";

const { TRUESTEP_BINARY: binary, TRUESTEP_URL: running } = process.env;
if (!binary && !running) throw new Error("set TRUESTEP_BINARY to the executable, or TRUESTEP_URL to a running service");

const server = binary ? await serveBinary(binary) : { url: running, stop: () => {} };
export const { url } = server;
/** `bad`: console errors and uncaught exceptions so far. */
export const { browser, page, bad } = await openChromium().catch(async (error) => {
  await server.stop();
  throw error;
});

after(async () => {
  await browser.close();
  await server.stop();
});

/** Errors that a test has caused on purpose are not counted. */
export function expected(pattern) {
  bad.splice(0, bad.length, ...bad.filter((text) => !pattern.test(text)));
}

let broken;
/** A step of a person's way, which builds on those before it: after one that failed the others fail at once. */
export function step(name, body) {
  test(name, async () => {
    if (broken) throw new Error(`not tried, for "${broken}" failed`);
    broken = name;
    await body();
    broken = undefined;
  });
}
