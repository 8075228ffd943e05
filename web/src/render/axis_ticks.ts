// Round values along a plot's axis and how they are written; what an axis shows and where comes with the topology.
import type { PlotAxis } from "../client/gen/truestep/v1/stream_pb";

export interface Tick {
  /** Along the plot's axis. */
  at: number;
  label: string;
}

/** A number as written on an axis. */
export function tickText(value: number): string {
  if (value === 0) return "0";
  const size = Math.abs(value);
  const text = size >= 1e5 || size < 1e-3 ? value.toExponential(5).replace(/\.?0*e\+?/, "e") : String(+value.toPrecision(6));
  return text.replace("-", "\u2212").replace("e-", "e\u2212");
}

/** Round values from `low` to `high`, about `wanted` of them. */
export function roundValues(low: number, high: number, wanted: number): number[] {
  if (!(high > low)) return [];
  const rough = (high - low) / wanted;
  const base = 10 ** Math.floor(Math.log10(rough));
  const step = base * [1, 2, 5, 10].find((factor) => factor * base >= rough * 0.999)!;
  const out: number[] = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) out.push(+(k * step).toPrecision(12));
  return out;
}

/** Where an axis draws a value; between its powers of ten, by the value's logarithm. */
export function placeOf({ slope, offset, decades }: Pick<PlotAxis, "slope" | "offset" | "decades">, value: number): number {
  if (decades.length < 4) return offset + slope * value;
  if (!(value > decades[0]!)) return decades[1]!;
  let k = 2;
  while (k + 2 < decades.length && decades[k]! < value) k += 2;
  const [v0, p0, v1, p1] = decades.slice(k - 2, k + 2) as [number, number, number, number];
  return p0 + ((p1 - p0) * Math.log(value / v0)) / Math.log(v1 / v0);
}

/** Ticks of an axis from `low` to `high` (m in the drawing), and its name. */
export function axisOf(axis: Pick<PlotAxis, "name" | "unit" | "slope" | "offset" | "decades">, low: number, high: number, wanted: number): { label: string; ticks: Tick[] } {
  const { name, unit, decades } = axis;
  const label = unit && unit !== "1" ? `${name} (${unit})` : name;
  const even = ({ slope, offset }: { slope: number; offset: number }): { label: string; ticks: Tick[] } => {
    const [from, to] = [(low - offset) / slope, (high - offset) / slope];
    return { label, ticks: roundValues(Math.min(from, to), Math.max(from, to), wanted).map((value) => ({ at: offset + slope * value, label: tickText(value) })) };
  };
  if (decades.length < 4) return even(axis);
  const inside: Tick[] = [];
  for (let k = 0; k < decades.length; k += 2) if (decades[k + 1]! >= low && decades[k + 1]! <= high) inside.push({ at: decades[k + 1]!, label: tickText(decades[k]!) });
  const widest = inside.reduce((most, { at }, k) => (k > 0 ? Math.max(most, at - inside[k - 1]!.at) : most), 0);
  // Below the smallest value it resolves, a logarithm with an offset has overlapping decades.
  const apart = inside.filter(({ at }, k) => (inside[k + 1]?.at ?? Infinity) - at > 0.4 * widest);
  const ticks: Tick[] = [];
  for (const tick of apart) if (ticks.length === 0 || tick.at - ticks.at(-1)!.at > (0.7 * (high - low)) / (1.8 * wanted)) ticks.push(tick);
  return ticks.length >= 2 ? { label, ticks } : even({ slope: 1, offset: 0 });
}
