// What a plot shows, independent of the page: which observables at first, where samples are missing, how ticks are
// written.

export interface Choice {
  title: string;
  names: string[];
}

/** At most this many lines are chosen at first where they have one unit. */
const kFirst = 4;

/**
 * What a scene lists as its observables, if no energy is among them: what has the unit of the first. Otherwise, of one
 * system its kinetic, potential and total energy; of several the energy of each, to compare them.
 */
export function chooseAtFirst(names: readonly string[], listed: readonly string[] = [], units: ReadonlyMap<string, string> = new Map()): Choice {
  const of = (pattern: RegExp): string[] => names.filter((name) => pattern.test(name));
  const wanted = listed.filter((name) => names.includes(name));
  const [lead] = wanted;
  if (lead !== undefined && !listed.some((name) => /energy/.test(name))) {
    return { title: "Observables", names: wanted.filter((name) => units.get(name) === units.get(lead)).slice(0, kFirst) };
  }
  const totals = of(/^.+\.energy\.total$/);
  if (totals.length > 1) return { title: "Total energy", names: totals };
  const kinetic = of(/^.+\.energy\.kinetic$/);
  if (kinetic.length > 1) return { title: "Kinetic energy", names: kinetic };
  const whole = of(/^energy\.(kinetic|potential|total)$/);
  if (whole.length > 0) return { title: "Energy", names: whole };
  const bookkeeping = /\.(integrator|count|events|stopped)\b/;
  const plain = names.filter((name) => !bookkeeping.test(name));
  return { title: "Observables", names: (plain.length > 0 ? plain : [...names]).slice(0, 3) };
}

/** A name, shortened by what the title already says. */
export function seriesLabel(name: string, title: string): string {
  if (/energy/i.test(title)) return name.replace(/\.energy\.(total|kinetic)$|^energy\./, "") || name;
  return name;
}

/** Rows before which samples are missing: the gap is many times the usual distance, and visible in the plot. */
export function gapsIn(times: readonly number[]): number[] {
  if (times.length < 4) return [];
  const steps = times.slice(1).map((t, k) => t - times[k]!);
  const usual = [...steps].sort((a, b) => a - b)[Math.floor(0.75 * (steps.length - 1))]!;
  const least = Math.max(8 * usual, (times.at(-1)! - times[0]!) / 15);
  return steps.flatMap((step, k) => (step > least ? [k + 1] : []));
}

/** Changes since the first value, relative to it; absolute where it is zero. */
export function relative(column: readonly (number | null)[]): (number | null)[] {
  const first = column.find((value) => value !== null) ?? 0;
  const size = Math.abs(first) || 1;
  return column.map((value) => (value === null ? null : (value - first) / size));
}

/** Labels of ticks `step` apart, and the power of ten to be shown on the axis. */
export function scaleOf(ticks: readonly number[], step: number): { exponent: number; labels: string[] } {
  const size = ticks.reduce((most, tick) => Math.max(most, Math.abs(tick)), 0);
  const power = size > 0 ? Math.floor(Math.log10(size) + 1e-9) : 0;
  const exponent = power >= 5 || power <= -3 ? 3 * Math.floor(power / 3) : 0;
  const scaled = step / 10 ** exponent;
  const digits = Math.min(12, Math.max(0, -Math.floor(Math.log10(scaled) + 1e-6)));
  return { exponent, labels: ticks.map((tick) => (Math.abs(tick) < 1e-9 * step ? "0" : (tick / 10 ** exponent).toFixed(digits).replace("-", "−"))) };
}

/** Both ends of a range with four digits of the larger: beside 0.8774 an end of 4e-6 is 0. */
export function endsOf(low: number, high: number): [string, string] {
  const largest = Math.max(Math.abs(low), Math.abs(high));
  const unit = largest > 0 && Number.isFinite(largest) ? 10 ** (Math.floor(Math.log10(largest)) - 3) : 1;
  const text = (x: number): string => String(Number((Math.round(x / unit) * unit).toPrecision(4)) || 0);
  return [text(low), text(high)];
}
