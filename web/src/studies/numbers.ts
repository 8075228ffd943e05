// Numbers in readable form: powers of ten with superscripts, times with a suitable unit.
const raised = "⁰¹²³⁴⁵⁶⁷⁸⁹";

/** 10 to the power n as text: 1, 10, 100, otherwise 10³ and 10⁻⁶. */
export function power(n: number): string {
  if (n >= 0 && n <= 2) return String(10 ** n);
  return `10${n < 0 ? "⁻" : ""}${String(Math.abs(n)).replace(/\d/g, (digit) => raised[Number(digit)]!)}`;
}

/** Three significant digits: 0.0213, 51,600 and 4.57·10⁻¹⁰. */
export function quantity(value: number, digits = 3): string {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e-2 && size < 1e6) return (+value.toPrecision(digits)).toLocaleString("en-US", { maximumFractionDigits: 8 });
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e") as [string, string];
  const front = String(+mantissa);
  const sign = front.startsWith("-") ? "−" : "";
  const body = front.replace("-", "");
  return `${sign}${body === "1" ? "" : `${body}·`}${power(Number(exponent))}`;
}

const units: [number, string][] = [[1e-9, "ns"], [1e-6, "µs"], [1e-3, "ms"], [1, "s"]];

/** A time in s with the unit that leaves few zeros: 34.5 µs, 2 ms, 120 s. */
export function duration(seconds: number, digits = 3): string {
  if (!Number.isFinite(seconds)) return "–";
  if (seconds === 0) return "0 s";
  const size = Math.abs(seconds) * (1 + 1e-12);
  if (size < 1e-12 || size >= 1e5) return `${quantity(seconds, digits)} s`;
  const [scale, unit] = units.filter(([least]) => size >= least).at(-1) ?? units[0]!;
  return `${+(seconds / scale).toPrecision(digits)} ${unit}`;
}

/** "cpu_seconds" as a heading: CPU time; other names with blanks. */
export function heading(name: string): string {
  const known: Record<string, string> = {
    cpu_seconds: "CPU time", error_end: "error at the end", error_path: "largest error on the way", largest_stable_dt: "largest stable step",
    theory_dt: "theory", observed_order: "observed order", setting: "step or tolerance",
  };
  return known[name] ?? name.replaceAll("_", " ");
}

/** A value of a column: times with their unit, other numbers with three digits, nothing as a dash. */
export function cellText(value: unknown, unit: string, name = ""): string {
  if (typeof value === "string") return value;
  if (typeof value !== "number") return "–";
  if (Number.isInteger(value) && (unit === "" || unit === "1") && Math.abs(value) < 1e9) return value.toLocaleString("en-US");
  return unit === "s" && name !== "time" ? duration(value) : quantity(value);
}
