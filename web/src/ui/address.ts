// What a shared address contains: the session while it lives, and after # how to recreate it: the scene (a gallery name
// or its packed text), the time, the camera.
import type { Scene } from "../client/rest";

export interface Shared {
  gallery?: string;
  scene?: Scene;
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

async function unpackScene(text: string): Promise<Scene> {
  const bytes = Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (c) => c.charCodeAt(0));
  return JSON.parse(new TextDecoder().decode(await through(bytes, new DecompressionStream("deflate-raw") as never))) as Scene;
}

/** Parses the part of the address after #; empty if it says nothing. */
export async function readShared(hash: string): Promise<Shared> {
  const said = new URLSearchParams(hash.replace(/^#/, ""));
  const shared: Shared = {};
  const gallery = said.get("scene");
  const packed = said.get("s");
  if (gallery) shared.gallery = gallery;
  else if (packed) shared.scene = await unpackScene(packed).catch(() => undefined);
  const time = Number(said.get("t") ?? Number.NaN);
  if (time > 0 && Number.isFinite(time)) shared.time = time;
  const eye = vector(said.get("eye"));
  const target = vector(said.get("target"));
  if (eye && target) Object.assign(shared, { eye, target });
  return shared;
}

const short = (numbers: number[]): string => numbers.map((x) => String(+x.toPrecision(5))).join(",");

/** The part after # for what is on the screen; `packed` is the scene's text, unless a gallery name suffices. */
export function writeShared({ gallery, packed, time, eye, target }: { gallery?: string | undefined; packed?: string | undefined; time: number; eye?: number[]; target?: number[] }): string {
  const parts: string[] = [];
  if (gallery) parts.push(`scene=${encodeURIComponent(gallery)}`);
  else if (packed) parts.push(`s=${packed}`);
  if (parts.length === 0) return "";
  if (time > 0) parts.push(`t=${+time.toPrecision(7)}`);
  if (eye && target) parts.push(`eye=${short(eye)}`, `target=${short(target)}`);
  return `#${parts.join("&")}`;
}
