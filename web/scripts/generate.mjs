// Generates src/client/gen from /proto with protoc and protoc-gen-es. The result is committed, so a machine
// without protoc (Debian's protobuf-compiler) still builds the viewer; it says that it uses the committed one.
import { spawnSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import path from "node:path";

const web = path.dirname(path.dirname(fileURLToPath(import.meta.url)));
const proto = path.join(web, "..", "proto");
const out = path.join(web, "src", "client", "gen");
const run = spawnSync(
  "protoc",
  [
    `--plugin=protoc-gen-es=${path.join(web, "node_modules", ".bin", "protoc-gen-es")}`,
    `--es_out=${out}`,
    "--es_opt=target=ts",
    `-I${proto}`,
    "truestep/v1/stream.proto",
  ],
  { stdio: "inherit" },
);
if (run.error?.code === "ENOENT") {
  console.log("generate: no protoc here, the committed src/client/gen is used");
} else if (run.status !== 0) {
  process.exit(run.status ?? 1);
} else {
  const file = path.join(out, "truestep/v1/stream_pb.ts");
  const head = "// Longer than 800 lines because it is generated, one file per .proto file, by scripts/generate.mjs.\n";
  writeFileSync(file, head + readFileSync(file, "utf8"));
}
