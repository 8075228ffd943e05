// Bundles src/client for Node into build/client.mjs: the stream client that the tests use.
import { build } from "esbuild";
import { fileURLToPath } from "node:url";
import path from "node:path";

const web = path.dirname(path.dirname(fileURLToPath(import.meta.url)));
await build({
  entryPoints: [path.join(web, "src/client/index.ts")],
  outfile: path.join(web, "build/client.mjs"),
  bundle: true,
  format: "esm",
  platform: "neutral",
  target: "es2022",
  mainFields: ["module", "main"],
  logLevel: "warning",
});
