// Just enough of a scene's expressions to draw the axes of its plots: an expression of one name as a function of
// that name's value.

type Node = (value: number) => number;
const functions: Record<string, (x: number) => number> = { log: Math.log, log10: Math.log10, log2: Math.log2, exp: Math.exp, sqrt: Math.sqrt, abs: Math.abs, sin: Math.sin, cos: Math.cos, tanh: Math.tanh };

export interface OneName {
  /** The name, without an index: "y" of "y[i]". */
  name: string;
  of: Node;
}

/** The expression as a function of its only name; undefined where it has none, several, or more than arithmetic. */
export function readOne(text: string, constants: Record<string, number>): OneName | undefined {
  const tokens = text.match(/\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+|[A-Za-z_]\w*'*(?:\[[^\]]*\])?|[-+*/^()]|\S/g) ?? [];
  let at = 0;
  const names = new Set<string>();
  const bad = (): never => {
    throw new Error("not of this kind");
  };
  const primary = (): Node => {
    const token = tokens[at++] ?? bad();
    if (token === "(") {
      const inner = sum();
      if (tokens[at++] !== ")") bad();
      return inner;
    }
    if (token === "-") {
      const inner = power();
      return (v) => -inner(v);
    }
    if (/^[\d.]/.test(token)) return () => Number(token);
    if (!/^[A-Za-z_]/.test(token)) bad();
    if (tokens[at] === "(") {
      const f = functions[token] ?? bad();
      const inner = primary();
      return (v) => f(inner(v));
    }
    if (token === "pi") return () => Math.PI;
    const known = constants[token];
    if (known !== undefined) return () => known;
    names.add(token.replace(/\[.*\]/, ""));
    return (v) => v;
  };
  const power = (): Node => {
    const base = primary();
    if (tokens[at] !== "^") return base;
    ++at;
    const exponent = power();
    return (v) => base(v) ** exponent(v);
  };
  const product = (): Node => {
    let left = power();
    while (tokens[at] === "*" || tokens[at] === "/") {
      const divide = tokens[at++] === "/";
      const [a, b] = [left, power()];
      left = divide ? (v) => a(v) / b(v) : (v) => a(v) * b(v);
    }
    return left;
  };
  const sum = (): Node => {
    let left = product();
    while (tokens[at] === "+" || tokens[at] === "-") {
      const minus = tokens[at++] === "-";
      const [a, b] = [left, product()];
      left = minus ? (v) => a(v) - b(v) : (v) => a(v) + b(v);
    }
    return left;
  };
  try {
    const of = sum();
    const [name] = names;
    return at === tokens.length && names.size === 1 && name !== undefined ? { name, of } : undefined;
  } catch {
    return undefined;
  }
}

export interface Tick {
  /** Along the plot's axis. */
  at: number;
  label: string;
}

/** A number as an axis writes it. */
export function tickText(value: number): string {
  if (value === 0) return "0";
  const size = Math.abs(value);
  const text = size >= 1e5 || size < 1e-3 ? value.toExponential().replace(/\.?0*e\+?/, "e") : String(+value.toPrecision(6));
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

/** Ticks of an axis from `low` to `high` (m of the drawing) that shows `text`, and what the axis is called. */
export function axisOf(text: string, constants: Record<string, number>, low: number, high: number, wanted: number): { label: string; ticks: Tick[] } {
  const one = readOne(text, constants);
  const own = (): { label: string; ticks: Tick[] } => ({ label: text.replace(/\s+/g, " "), ticks: roundValues(low, high, wanted).map((at) => ({ at, label: tickText(at) })) });
  if (!one) return own();
  const { name, of } = one;
  const [a, b, c] = [of(0), of(1), of(2.5)];
  const slope = b - a;
  if (Number.isFinite(a + b + c) && slope !== 0 && Math.abs(c - a - 2.5 * slope) < 1e-9 * (Math.abs(a) + Math.abs(slope))) {
    const [from, to] = [(low - a) / slope, (high - a) / slope];
    return { label: name, ticks: roundValues(Math.min(from, to), Math.max(from, to), wanted).map((value) => ({ at: of(value), label: tickText(value) })) };
  }
  // A logarithm: decades.
  const decades = Array.from({ length: 41 }, (_, k) => 10 ** (k - 20)).map((value) => ({ at: of(value), label: tickText(value) })).filter(({ at }) => Number.isFinite(at) && at >= low && at <= high);
  const ticks: Tick[] = [];
  const widest = decades.reduce((most, { at }, k) => (k > 0 ? Math.max(most, Math.abs(at - decades[k - 1]!.at)) : most), 0);
  // Below the smallest value that it tells apart, a logarithm with an offset has decades on top of each other.
  const apart = decades.filter(({ at }, k) => Math.abs((decades[k + 1]?.at ?? Infinity) - at) > 0.4 * widest);
  for (const tick of apart) if (ticks.length === 0 || Math.abs(tick.at - ticks.at(-1)!.at) > (0.7 * (high - low)) / (1.8 * wanted)) ticks.push(tick);
  return ticks.length >= 2 ? { label: name, ticks } : own();
}
