// Bundles for Node what the tests use: src/client into build/client.mjs, what src/studies computes into
// build/studies.mjs, and what the viewer computes without a page into build/view.mjs.
import { build } from "esbuild";
import { fileURLToPath } from "node:url";
import path from "node:path";

const web = path.dirname(path.dirname(fileURLToPath(import.meta.url)));
await build({
  entryPoints: { client: path.join(web, "src/client/index.ts"), studies: path.join(web, "src/studies/index.ts"), view: path.join(web, "src/ui/index.ts") },
  outdir: path.join(web, "build"),
  outExtension: { ".js": ".mjs" },
  bundle: true,
  format: "esm",
  platform: "neutral",
  target: "es2022",
  mainFields: ["module", "main"],
  logLevel: "warning",
});
