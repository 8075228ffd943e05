// How fast a scene may be played, and how fast it is at first.
const near = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.25, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
/** Atoms move in picoseconds and planets in years. */
const all = [...steps(-18, -3), ...near, ...steps(3, 14).slice(1)];

function steps(from: number, to: number): number[] {
  const out: number[] = [];
  for (let k = from; k < to; ++k) for (const digit of [1, 2, 5]) out.push(Number(`${digit}e${k}`));
  return out;
}

const kLeast = 0.5; // steps a second of the slowest speed
const kMost = 20000; // of the fastest
const kShort = 5; // s that a run should last at least
const kLong = 90; // and at most

/** Speeds at which steps of `dt` (s) are neither visible one by one nor ten thousands at a time; includes 1 if that makes sense. */
export function speedsFor(dt: number | undefined): number[] {
  if (!dt || !(dt > 0)) return all.filter((speed) => speed >= 0.05 && speed <= 100);
  const some = all.filter((speed) => speed / dt >= kLeast && speed / dt <= kMost);
  return dt >= 1e-4 && dt <= 10 && !some.includes(1) ? [...some, 1].sort((a, b) => a - b) : some;
}

/** A speed at which a run of `duration` (s) takes neither a blink nor an afternoon; 1 if possible. */
export function speedAtFirst(dt: number | undefined, duration: number | undefined): number {
  const speeds = speedsFor(dt);
  if (duration === undefined || !(duration > 0)) return 1;
  if (duration < 1.5) return speeds.filter((speed) => duration / speed >= kShort).at(-1) ?? speeds[0]!;
  if (duration > kLong) return speeds.find((speed) => duration / speed <= 0.4 * kLong) ?? speeds.at(-1)!;
  return 1;
}

/** Speeds in readable form: 0.05, 1,000. */
export const speedText = (speed: number): string =>
  speed >= 1e-3 && speed < 1e6 ? `${speed.toLocaleString("en-US", { maximumSignificantDigits: 3 })}×` : `${speed.toExponential(0).replace("e+", "e")}×`;
