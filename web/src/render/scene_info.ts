// Information about a scene that is not itself drawn.
import type { Scene } from "../client/rest";

export interface SceneInfo {
  /** There is gravity, and therefore a floor, unless everything is a plot. */
  pulled: boolean;
  /** m/s2, of the whole scene. */
  gravity: number[];
  /** Observables that the scene lists. */
  observables: string[];
  /** Rows that probes watch. */
  probes: { name: string; system: string; row: number }[];
  duration: number | undefined;
  dt: number | undefined;
}

type Json = Record<string, unknown>;
const number = (value: unknown): number | undefined => (typeof value === "number" ? value : undefined);

/** What is known about `scene` (the session's own, with defaults); defaults without it. */
export function infoOf(scene: Scene | undefined): SceneInfo {
  const time = (scene?.time as Json | undefined) ?? {};
  const gravity = Array.isArray(scene?.gravity) ? scene.gravity.map(Number) : [0, -9.81, 0];
  const observables = Array.isArray(scene?.observables) ? scene.observables.filter((name) => typeof name === "string") : [];
  const probes = (Array.isArray(scene?.probes) ? (scene.probes as Json[]) : [])
    .filter((probe) => !probe.at && (probe.rows ?? "one") === "one")
    .map((probe) => ({ name: String(probe.id).replaceAll("_", " "), system: String(probe.system), row: Number(probe.index ?? 0) }));
  return { pulled: gravity.some((g) => g !== 0), gravity, observables, probes, duration: number(time.duration), dt: number(time.dt) };
}

/** The same scene with another step. */
export function withStep(scene: Scene, dt: number): Scene {
  return { ...scene, time: { ...(scene.time as Json | undefined), dt } };
}
