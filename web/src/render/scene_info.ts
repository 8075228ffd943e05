// What a scene says beyond its fields: whether it stands on something, whether it lies in a plane, what its plots'
// axes mean, and which invisible strings hold its bodies.
import type { Scene } from "../client/rest";

/** A string between two places, each a point of the world or of a row of a part. */
export interface StringEnd {
  part?: string;
  row?: number;
  /** In the world, or in the row's frame. */
  at: [number, number, number];
}

export interface PlotInfo {
  system: string;
  /** The expressions that are drawn along x, y and z; the names of states stand for themselves. */
  axes: string[];
  constants: Record<string, number>;
  duration: number | undefined;
}

export interface SceneInfo {
  /** Gravity pulls: there is a floor. */
  standing: boolean;
  /** Everything lies in the plane z = 0. */
  flat: boolean;
  plots: PlotInfo[];
  strings: [StringEnd, StringEnd][];
  duration: number | undefined;
  dt: number | undefined;
}

type Json = Record<string, unknown>;
const list = (value: unknown): Json[] => (Array.isArray(value) ? (value as Json[]) : []);
const vector = (value: unknown): [number, number, number] | undefined => (Array.isArray(value) && value.length === 3 && value.every((x) => typeof x === "number") ? (value as [number, number, number]) : undefined);
const number = (value: unknown): number | undefined => (typeof value === "number" ? value : undefined);

const flatTypes = new Set(["rigid2d", "oscillator"]);

/** The axes that an ode shows if it does not say. */
function defaultAxes(system: Json): string[] {
  const states = Object.keys((system.states as Json | undefined) ?? {});
  const common = ["x", "y", "z"].filter((name) => states.includes(name));
  return common.length >= 2 ? common : states.length >= 2 ? states.slice(0, 2) : [];
}

function plotOf(system: Json, duration: number | undefined): PlotInfo | undefined {
  if (system.type !== "ode" || system.tracers) return undefined;
  const given = Array.isArray(system.plot) ? (system.plot as string[]) : [];
  const axes = given.length > 0 ? given : defaultAxes(system);
  if (axes.length < 2) return undefined;
  const constants = Object.fromEntries(Object.entries((system.parameters as Json | undefined) ?? {}).filter(([, value]) => typeof value === "number")) as Record<string, number>;
  return { system: String(system.id), axes, constants, duration };
}

/** Distance joints of a system, and attachments of points that are apart. */
function stringsOf(scene: Scene, systems: Json[]): [StringEnd, StringEnd][] {
  const out: [StringEnd, StringEnd][] = [];
  for (const system of systems) {
    const bodies = list(system.bodies);
    const end = (row: unknown, anchor: [number, number, number] | undefined): StringEnd | undefined => {
      if (row === -1) return anchor && { at: anchor };
      // Bodies that are copied have rows that their place in the list does not tell.
      if (typeof row !== "number" || bodies.some((body) => body.copies)) return undefined;
      const place = vector(bodies[row]?.position);
      const local = anchor && place ? (anchor.map((c, k) => c - place[k]!) as [number, number, number]) : ([0, 0, 0] as [number, number, number]);
      return { part: String(system.id), row, at: local };
    };
    for (const joint of list(system.joints)) {
      if (joint.type !== "distance" && joint.type !== "spring") continue;
      const a = end(joint.a, vector(joint.anchor));
      const b = end(joint.b, vector(joint.anchor_b) ?? vector(joint.anchor));
      if (a && b) out.push([a, b]);
    }
  }
  for (const coupling of list(scene.couplings)) {
    if (coupling.type !== "attachment") continue;
    const [a, b] = [coupling.a_points, coupling.b_points].map((rows) => (Array.isArray(rows) ? (rows as number[]) : []));
    a!.forEach((row, k) => {
      if (b![k] !== undefined) out.push([{ part: String(coupling.a), row, at: [0, 0, 0] }, { part: String(coupling.b), row: b![k]!, at: [0, 0, 0] }]);
    });
  }
  return out;
}

/** Everything known about `scene` (the session's own, with defaults), or nothing much without it. */
export function infoOf(scene: Scene | undefined): SceneInfo {
  if (!scene) return { standing: true, flat: false, plots: [], strings: [], duration: undefined, dt: undefined };
  const systems = list(scene.systems);
  const time = (scene.time as Json | undefined) ?? {};
  const duration = number(time.duration);
  const plots = systems.map((system) => plotOf(system, duration)).filter((plot) => plot !== undefined);
  const plane = (system: Json): boolean => {
    const plot = plots.find((one) => one.system === system.id);
    if (plot) return plot.axes.length < 3;
    return flatTypes.has(String(system.type)) || (system.type === "ode" && !((system.tracers as Json | undefined)?.velocity as Json | undefined)?.z);
  };
  const gravity = vector(scene.gravity) ?? [0, -9.81, 0];
  return {
    standing: gravity.some((g) => g !== 0) && plots.length < systems.length,
    flat: systems.length > 0 && systems.every(plane),
    plots, strings: stringsOf(scene, systems), duration, dt: number(time.dt),
  };
}
