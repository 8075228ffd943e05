// Addresses of the viewer. `?gallery=NAME` or `#s=` with a packed scene says how to make a run, `?session=ID` shares the
// control of a session, `?watch=ID` only follows it; after # stand the time and the camera, too.
import { ProblemError } from "../../client/problem";
import type { Scene } from "../../client/rest";

export interface Asked {
  watch?: string;
  session?: string;
  gallery?: string;
  /** A scene as packScene writes it. */
  packed?: string;
  time?: number;
  eye?: number[];
  target?: number[];
}

const kLongest = 6000; // characters of a packed scene that an address carries

const vector = (text: string | null): number[] | undefined => {
  const numbers = (text ?? "").split(",").map(Number);
  return numbers.length === 3 && numbers.every(Number.isFinite) ? numbers : undefined;
};

async function through(bytes: Uint8Array, stream: ReadableWritablePair<Uint8Array, BufferSource>): Promise<Uint8Array> {
  return new Uint8Array(await new Response(new Blob([bytes as BlobPart]).stream().pipeThrough(stream as never)).arrayBuffer());
}

/** A scene as characters allowed in an address; undefined if it is too long. */
export async function packScene(scene: Scene): Promise<string | undefined> {
  const packed = await through(new TextEncoder().encode(JSON.stringify(scene)), new CompressionStream("deflate-raw") as never);
  const text = btoa(Array.from(packed, (byte) => String.fromCharCode(byte)).join("")).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
  return text.length <= kLongest ? text : undefined;
}

/** The scene of such characters; throws a ProblemError where they are not one. */
export async function unpackScene(text: string): Promise<Scene> {
  try {
    const bytes = Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (c) => c.charCodeAt(0));
    return JSON.parse(new TextDecoder().decode(await through(bytes, new DecompressionStream("deflate-raw") as never))) as Scene;
  } catch {
    throw new ProblemError({ title: "The address is not complete", status: 0, code: "bad_address", detail: "the scene in it ends too early; copy all of the link" });
  }
}

/** Parses an address's parts after ? and #. */
export function readAddress(search: string, hash: string): Asked {
  const query = new URLSearchParams(search);
  const said = new URLSearchParams(hash.replace(/^#/, ""));
  const asked: Asked = {};
  const watch = query.get("watch");
  const session = query.get("session");
  const gallery = query.get("gallery") ?? said.get("scene");
  const packed = said.get("s");
  if (watch) asked.watch = watch;
  else if (session) asked.session = session;
  if (gallery) asked.gallery = gallery;
  else if (packed) asked.packed = packed;
  const time = Number(said.get("t") ?? Number.NaN);
  if (time > 0 && Number.isFinite(time)) asked.time = time;
  const eye = vector(said.get("eye"));
  const target = vector(said.get("target"));
  if (eye && target) Object.assign(asked, { eye, target });
  return asked;
}

const short = (numbers: number[]): string => numbers.map((x) => String(+x.toPrecision(5))).join(",");

export type Shown = { [K in keyof Asked]?: Asked[K] | undefined };

/** The address of what is on the screen; "/" where nothing says how to make it. */
export function writeAddress({ watch, session, gallery, packed, time = 0, eye, target }: Shown): string {
  const open = watch ?? session;
  const query = open !== undefined ? `?${watch !== undefined ? "watch" : "session"}=${encodeURIComponent(open)}` : gallery ? `?gallery=${encodeURIComponent(gallery)}` : "";
  const parts: string[] = [];
  if (watch === undefined) {
    if (gallery && session !== undefined) parts.push(`scene=${encodeURIComponent(gallery)}`);
    else if (!gallery && packed) parts.push(`s=${packed}`);
    else if (!gallery) return `/${query}`;
    if (time > 0) parts.push(`t=${+time.toPrecision(7)}`);
  }
  if (eye && target) parts.push(`eye=${short(eye)}`, `target=${short(target)}`);
  return `/${query}${parts.length > 0 ? `#${parts.join("&")}` : ""}`;
}
