// What is drawn of a result: which curves, in which style, and which ones stand out.
import type { Row, Scale, StudyResult } from "../client/studies";
import { shows } from "./axis";
import { wordsOf } from "./words";

export type Manner = "curve" | "dashed" | "marks" | "rings" | "line";

export interface Curve {
  name: string;
  manner: Manner;
  points: { x: number; y: number }[];
}

export interface Model {
  title: string;
  xLabel: string;
  yLabel: string;
  xUnit: string;
  yUnit: string;
  xScale: Scale;
  yScale: Scale;
  curves: Curve[];
  /** Names along the y axis, whose values are then 0, 1, 2 ... from the top. */
  categories: string[];
  /** Names of the curves in colour; the others stay in the background until asked for. */
  front: string[];
}

const kAllInColour = 6;

/** "CPU time in s" as label and unit. */
export function splitLabel(label: string): { label: string; unit: string } {
  const match = /^(.*) in (\S+)$/.exec(label);
  return match ? { label: match[1]!, unit: match[2]! } : { label, unit: "" };
}

const sentence = (text: string): string => (text.startsWith("/") || /^\w+\.\w/.test(text) ? text : text.charAt(0).toUpperCase() + text.slice(1));

/** The best methods first, then those next to them until there are kAllInColour. */
function frontOf(result: StudyResult, names: string[]): string[] {
  if (names.length <= kAllInColour) return names;
  const best = [...new Set(wordsOf(result).winners.map((winner) => winner.method))].filter((name) => names.includes(name));
  return best.length > 0 ? best : names.slice(0, kAllInColour);
}

/** One line a method, because names read better along the side than under a plot. */
function stabilityModel(result: StudyResult): Model {
  const rows = result.rows.filter((row) => shows("log", row.largest_stable_dt as number | null) || shows("log", row.theory_dt as number | null));
  const points = (column: string): { x: number; y: number }[] => rows.flatMap((row, y) => (shows("log", row[column] as number | null) ? [{ x: row[column] as number, y }] : []));
  const curves: Curve[] = [
    { name: "linear theory", manner: "rings", points: points("theory_dt") },
    { name: "measured", manner: "marks", points: points("largest_stable_dt") },
  ];
  // Some methods are stable again above their first limit: where each of these spans begins and ends.
  const again = (result.summary.stable_again ?? {}) as Record<string, { from: number; to: number }[]>;
  const ends = rows.flatMap((row, y) => (again[String(row.integrator)] ?? []).flatMap((span) => [{ x: span.from, y }, { x: span.to, y }]));
  if (ends.length > 0) curves.push({ name: "stable again", manner: "rings", points: ends });
  return {
    title: result.plot.title, xLabel: "Step", yLabel: "", xUnit: "s", yUnit: "", xScale: "log", yScale: "linear",
    curves, categories: rows.map((row) => String(row.integrator)), front: ["measured", "linear theory"],
  };
}

/** "/systems/0/drag = 5E-2" as "drag = 0.05": the axis of a sweep and its number as a person writes them. */
export const curveName = (name: string): string => name.replace(/\/[\w/~]*\/(\w+) = /g, "$1 = ").replace(/\b\d+(\.\d+)?E-?\d+\b/g, (digits) => String(+Number(digits).toPrecision(6)));

export function modelOf(result: StudyResult): Model {
  if (result.summary.kind === "stability") return stabilityModel(result);
  const { plot } = result;
  const x = splitLabel(plot.x_label);
  const y = splitLabel(plot.y_label);
  const curves = plot.series
    .map((series): Curve => {
      const points = series.x.flatMap((at, k) => {
        const value = series.y[k];
        return shows(plot.x_scale, at) && shows(plot.y_scale, value) ? [{ x: at, y: value }] : [];
      });
      const manner: Manner = /^order \d/.test(series.name) ? "dashed" : result.summary.kind === "sweep" && isCloud(points) ? "marks" : points.length > 60 ? "line" : "curve";
      return { name: curveName(series.name), manner, points };
    })
    .filter((curve) => curve.points.length > 0);
  return {
    title: plot.title, xLabel: sentence(x.label), yLabel: sentence(y.label), xUnit: x.unit, yUnit: y.unit, xScale: plot.x_scale, yScale: plot.y_scale,
    curves, categories: [], front: frontOf(result, curves.map((curve) => curve.name)),
  };
}

/** Random draws come in no order, so that no line joins them. */
function isCloud(points: { x: number }[]): boolean {
  return points.some((point, k) => k > 0 && point.x < points[k - 1]!.x);
}

/** The row of the table that a point was made from. */
export function rowOf(result: StudyResult, model: Model, curve: Curve, point: { x: number; y: number }): Row | undefined {
  if (model.categories.length > 0) return result.rows.find((row) => row.integrator === model.categories[point.y]);
  return result.rows.find((row) => {
    const values = Object.values(row);
    const own = result.summary.kind !== "work_precision" || row.integrator === curve.name;
    return own && values.includes(point.x) && values.includes(point.y);
  });
}
