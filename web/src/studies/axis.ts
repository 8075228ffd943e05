// One axis of a plot: where a value lies between 0 and 1, and which values deserve a label.
import type { Scale } from "../client/studies";
import { duration, power, quantity } from "./numbers";

export interface Tick {
  at: number;
  label: string;
}

export interface Axis {
  scale: Scale;
  min: number;
  max: number;
  ticks: Tick[];
  /** Values of fine lines without a label. */
  minor: number[];
}

/** True for values that the scale can show. */
export const shows = (scale: Scale, value: number | null | undefined): value is number =>
  typeof value === "number" && Number.isFinite(value) && (scale === "linear" || value > 0);

/** Position of `value` on the axis: 0 at its start, 1 at its end. */
export function place(axis: Axis, value: number): number {
  if (axis.scale === "linear") return (value - axis.min) / (axis.max - axis.min);
  return Math.log(value / axis.min) / Math.log(axis.max / axis.min);
}

/** An axis around all `values` with about `wanted` labels; with `unit` "s", times get a suitable unit. */
export function makeAxis(values: readonly (number | null)[], scale: Scale, wanted: number, unit = ""): Axis {
  const good = values.filter((value): value is number => shows(scale, value));
  const low = good.length > 0 ? good.reduce((a, b) => Math.min(a, b)) : scale === "log" ? 0.1 : 0;
  const high = good.length > 0 ? good.reduce((a, b) => Math.max(a, b)) : 1;
  return scale === "log" ? logarithmic(low, high, wanted, unit) : linear(low, high, wanted, unit);
}

function logarithmic(low: number, high: number, wanted: number, unit: string): Axis {
  let from = Math.log10(low);
  let to = Math.log10(high);
  const spare = Math.max(0.04 * (to - from), (0.6 - (to - from)) / 2, 0.05);
  from -= spare;
  to += spare;
  const decades: number[] = [];
  for (let n = Math.ceil(from - 1e-9); n <= to + 1e-9; ++n) decades.push(n);
  const inside = (value: number): boolean => Math.log10(value) >= from && Math.log10(value) <= to;
  const fine = [Math.floor(from), ...decades].flatMap((n) => [2, 3, 4, 5, 6, 7, 8, 9].map((digit) => digit * 10 ** n)).filter(inside);
  const write = (value: number): string => (unit === "s" ? duration(value) : quantity(value));
  let ticks: Tick[];
  if (decades.length >= 3) {
    const every = Math.max(1, Math.ceil(decades.length / Math.max(2, wanted)));
    ticks = decades.filter((n) => n % every === 0).map((n) => ({ at: 10 ** n, label: unit === "s" && n >= -9 && n < 4 ? duration(10 ** n) : power(n) }));
  } else {
    // Less than three decades: 1, 2 and 5 of each get a label too.
    ticks = [...decades.map((n) => 10 ** n), ...fine.filter((value) => ["2", "5"].includes(value.toExponential(0)[0]!))].sort((a, b) => a - b).map((at) => ({ at, label: write(at) }));
  }
  const labelled = new Set(ticks.map((tick) => tick.at));
  const minor = decades.length > 6 ? decades.map((n) => 10 ** n) : decades.length > 3 ? [] : fine;
  return { scale: "log", min: 10 ** from, max: 10 ** to, ticks, minor: minor.filter((value) => !labelled.has(value)) };
}

function linear(low: number, high: number, wanted: number, unit: string): Axis {
  const range = high > low ? high - low : Math.abs(high) || 1;
  const min = high > low ? low - 0.03 * range : low - 0.5 * range;
  const max = high > low ? high + 0.03 * range : high + 0.5 * range;
  const rough = (max - min) / Math.max(2, wanted);
  const base = 10 ** Math.floor(Math.log10(rough));
  const step = base * ([1, 2, 2.5, 5, 10].find((factor) => factor * base >= rough) ?? 10);
  const ticks: Tick[] = [];
  for (let k = Math.ceil(min / step - 1e-9); k * step <= max + 1e-9 * range; ++k) {
    const at = k === 0 ? 0 : k * step;
    ticks.push({ at, label: `${quantity(at, 4)}${unit === "s" ? " s" : ""}` });
  }
  return { scale: "linear", min, max, ticks, minor: [] };
}
