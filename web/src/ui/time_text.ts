// A time of a run in words, as in the service's pictures (engine/sinks/picture/draw/draw_names): in the unit of which
// the run takes neither thousands nor thousandths.
const units: [least: number, size: number, name: string][] = [
  [6.3e7, 31557600, "years"],
  [2e5, 86400, "days"],
  [1e-2, 1, "s"],
  [1e-3, 1e-3, "ms"],
  [1e-6, 1e-6, "µs"],
  [1e-9, 1e-9, "ns"],
  [0, 1e-12, "ps"],
];

/** `time` s of a run of `duration` s. */
export function timeText(time: number, duration = 0): string {
  const run = Math.max(Math.abs(time), Number.isFinite(duration) ? duration : 0);
  const [, size, name] = (run > 0 ? units.find(([least]) => run >= least) : undefined) ?? units[2]!;
  const value = time / size;
  if (Math.abs(value) >= 1e6) return `${value.toPrecision(4)} ${name}`;
  return `${value.toFixed(size === 1 ? 3 : run / size < 100 ? 2 : 1)} ${name}`;
}
