// What a scene says beyond what is drawn of it.
import type { Scene } from "../client/rest";

export interface SceneInfo {
  /** Gravity pulls: there is a floor, unless everything is a plot. */
  pulled: boolean;
  duration: number | undefined;
  dt: number | undefined;
}

type Json = Record<string, unknown>;
const number = (value: unknown): number | undefined => (typeof value === "number" ? value : undefined);

/** Everything known about `scene` (the session's own, with defaults), or nothing much without it. */
export function infoOf(scene: Scene | undefined): SceneInfo {
  const time = (scene?.time as Json | undefined) ?? {};
  const gravity = Array.isArray(scene?.gravity) ? (scene.gravity as unknown[]) : [0, -9.81, 0];
  return { pulled: gravity.some((g) => g !== 0), duration: number(time.duration), dt: number(time.dt) };
}
