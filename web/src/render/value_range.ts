// Lowest and highest of the values that colours show, as in the service's pictures. It widens at once and narrows
// slowly, so that colours do not flicker.
const kNarrowing = 1.5; // s in which it narrows to 1/e

export class ValueRange {
  private low = Infinity;
  private high = -Infinity;
  private since = 0;

  /** Takes the values of a frame; what is not a number does not count. */
  take(values: ArrayLike<number>, count: number): void {
    let low = Infinity;
    let high = -Infinity;
    for (let k = 0; k < count; ++k) {
      const v = values[k]!;
      if (v < low && v !== -Infinity) low = v;
      if (v > high && v !== Infinity) high = v;
    }
    if (low > high) return;
    const now = performance.now();
    const share = 1 - Math.exp((this.since - now) / (1e3 * kNarrowing));
    this.since = now;
    const slack = this.low <= this.high ? share * (this.high - this.low) : Infinity;
    this.low = Math.min(low, this.low + slack);
    this.high = Math.max(high, this.high - slack);
    if (!Number.isFinite(this.low)) this.low = low;
    if (!Number.isFinite(this.high)) this.high = high;
  }

  forget(): void {
    this.low = Infinity;
    this.high = -Infinity;
  }

  /** Undefined before the first values. */
  get ends(): [number, number] | undefined {
    return this.low <= this.high ? [this.low, this.high] : undefined;
  }
}

/** The range of all of `ranges` together. */
export function widest(ranges: readonly ([number, number] | undefined)[]): [number, number] | undefined {
  const given = ranges.filter((range) => range !== undefined);
  if (given.length === 0) return undefined;
  return [Math.min(...given.map(([low]) => low)), Math.max(...given.map(([, high]) => high))];
}
