// What a study found, in sentences.
import type { StudyResult, Summary } from "../client/studies";
import { duration, power, quantity } from "./numbers";

/** The cheapest method that reaches an error. */
export interface Winner {
  error: string;
  method: string;
  seconds: number;
}

export interface Words {
  /** What must not be overlooked. */
  warnings: string[];
  /** The answer, in one to three sentences. */
  findings: string[];
  winners: Winner[];
  /** How it was measured. */
  basis: string[];
  /** Methods left out, each with its reason. */
  refused: { method: string; reason: string }[];
}

const titles: Record<string, string> = {
  work_precision: "Run time against error",
  convergence: "Order of convergence",
  stability: "Largest stable step",
  cross_check: "Two ways compared",
  sweep: "Parameter sweep",
};

const questions: Record<string, string> = {
  work_precision: "Which method is the cheapest at each error?",
  convergence: "How fast does the error fall when the step is halved?",
  stability: "How large may the step be before the scene breaks?",
  cross_check: "How far do two methods or engines drift apart over time?",
  sweep: "How does a quantity depend on parameters?",
};

/** What a kind of study answers; for unknown kinds, the service's own sentence. */
export const questionOf = (kind: string, sentence: string): string => questions[kind] ?? sentence;

export const titleOf = (kind: string): string => titles[kind] ?? kind.replaceAll("_", " ").replace(/^./, (first) => first.toUpperCase());

const number = (value: unknown): number | undefined => (typeof value === "number" && Number.isFinite(value) ? value : undefined);
const text = (value: unknown): string => (typeof value === "string" ? value : "");
const list = (value: unknown): Record<string, unknown>[] => (Array.isArray(value) ? (value as Record<string, unknown>[]) : []);
const plural = (n: number, noun: string): string => `${n.toLocaleString("en-US")} ${noun}${n === 1 ? "" : "s"}`;

/** How good the reference is, and what that means for small errors. */
function reference(summary: Summary): string[] {
  const r = summary.reference as Record<string, unknown> | undefined;
  if (!r) return [];
  const uncertainty = number(r.uncertainty);
  const doubt = uncertainty === undefined ? "the two do not agree" : uncertainty === 0 ? "the two agree in every digit" : `the two agree to ${quantity(uncertainty, 2)}`;
  const floor = uncertainty ? ` Errors below ${quantity(10 * uncertainty, 2)} say nothing about a method.` : "";
  return [`Errors are relative to ${text(r.method)}, checked by ${text(r.checked_by)}: ${doubt}.${floor}`];
}

function cutOff(result: StudyResult, words: Words): void {
  const count = (status: string): number => result.rows.filter((row) => row.status === status).length;
  const cut = count("over budget");
  if (cut > 0) words.basis.push(`${plural(cut, "curve")} ended early because the time budget ran out; a larger budget draws ${cut === 1 ? "it" : "them"} further.`);
  const unstable = count("unstable");
  if (unstable > 0) words.basis.push(`${plural(unstable, "run")} became unstable and ${unstable === 1 ? "is" : "are"} only in the table.`);
}

/** Says when the budget did not reach the whole duration. */
function reach({ summary }: StudyResult, words: Words): void {
  const note = text(summary.note);
  if (note) words.basis.push(note.charAt(0).toUpperCase() + note.slice(1) + ".");
}

function workPrecision(result: StudyResult, words: Words): void {
  const { summary } = result;
  words.winners = list(summary.cheapest).map((row) => ({ error: power(Math.round(Math.log10(number(row.error) ?? 1))), method: text(row.integrator), seconds: number(row.cpu_seconds) ?? Number.NaN }));
  const methods = [...new Set(words.winners.map((winner) => winner.method))];
  if (methods.length === 1) words.findings.push(`${methods[0]} is the cheapest at every error that was reached.`);
  else if (methods.length > 1) words.findings.push(`${methods[0]} is the cheapest for a coarse answer, ${methods.at(-1)} for the most accurate one.`);
  else words.findings.push("No method reached an error of 10⁻² or better within the budget.");
  const horizon = number(summary.horizon);
  if (horizon !== undefined) words.basis.push(`Simulated ${duration(horizon)}; CPU times are medians of repeated runs on one thread.`);
  reach(result, words);
  words.refused = list(summary.refused).map((row) => ({ method: text(row.integrator), reason: text(row.reason) }));
  cutOff(result, words);
}

function convergence(result: StudyResult, words: Words): void {
  const { summary } = result;
  // Either a system's resolution or a method's step was refined.
  const method = text(summary.subject) || text(summary.integrator);
  const observed = number(summary.observed_order);
  const promised = number(summary.promised_order);
  if (summary.adaptive === true) {
    const sound = result.rows.filter((row) => row.status === "ok" && typeof row.error_end === "number");
    const last = sound.at(-1);
    words.findings.push(`${method} adapts its steps to its tolerance, so the error is shown over that.`);
    if (last) words.findings.push(`At tolerance ${quantity(Number(last.tolerance))} it takes ${plural(Number(last.steps), "step")} and its error is ${quantity(Number(last.error_end))}.`);
    reach(result, words);
    cutOff(result, words);
    return;
  }
  const claim = promised === undefined ? "" : ` It promises ${promised}.`;
  if (observed !== undefined) {
    words.findings.push(`${method} converges with order ${observed.toFixed(2)}.${claim}`);
    if (promised !== undefined && observed < promised - 0.25) words.warnings.push(`The observed order ${observed.toFixed(2)} is below the promised ${promised}: forces that are not smooth, contacts or velocity-dependent forces do that.`);
  } else {
    words.findings.push(`The order of ${method} did not settle, so none is quoted.${claim}`);
    if (text(summary.reason)) words.warnings.push(text(summary.reason));
  }
  if (text(summary.measured_against)) words.basis.push(`Errors are relative to ${text(summary.measured_against)}.`);
  reach(result, words);
  cutOff(result, words);
}

function stability(result: StudyResult, words: Words): void {
  const { summary } = result;
  const omega = number(summary.omega_max);
  const best = result.rows.filter((row) => typeof row.largest_stable_dt === "number").sort((a, b) => Number(b.largest_stable_dt) - Number(a.largest_stable_dt))[0];
  if (best) words.findings.push(`${String(best.integrator)} allows the largest step of those with a limit: ${duration(Number(best.largest_stable_dt))}.`);
  const always = result.rows.filter((row) => /^stable at every/.test(String(row.status)));
  if (always.length > 0) words.findings.push(`Stable at every step tried: ${always.map((row) => row.integrator).join(", ")}.`);
  const suggested = number(summary.suggested_dt);
  if (suggested !== undefined) words.findings.push(`Suggested step for the scene's own method: ${duration(suggested)}, a tenth below its limit.`);
  if (omega) words.basis.push(`The stiffest mode at the start oscillates at ${quantity(omega)} rad/s, a period of ${duration((2 * Math.PI) / omega)}.`);
  const damping = number(summary.damping_max);
  if (damping) words.basis.push(`The strongest damping acts at ${quantity(damping)} per second.`);
}

function crossCheck(result: StudyResult, words: Words): void {
  const { summary } = result;
  const end = number(summary.difference_at_end);
  const last = result.rows.at(-1);
  if (end !== undefined) words.findings.push(end === 0 ? "The two agree in every digit at the end." : `After ${duration(Number(last?.time ?? 0))} the two differ by ${quantity(end)} of the quantity's size.`);
  const rate = number(summary.growth_rate);
  if (rate !== undefined && rate > 0) words.findings.push(`The difference grows about as e^(${quantity(rate)} t): tenfold every ${duration(Math.LN10 / rate)}.`);
  for (const name of ["a", "b"]) {
    const side = summary[name] as Record<string, unknown> | undefined;
    if (!side) continue;
    words.basis.push(`Way ${name}: ${plural(number(side.steps) ?? 0, "step")}, ${duration(number(side.cpu_seconds) ?? Number.NaN)} of CPU time.`);
    if (side.complete === false) words.warnings.push(`Way ${name} did not reach the end: it became unstable or ran out of its budget.`);
  }
}

function sweep(result: StudyResult, words: Words): void {
  const { summary } = result;
  const failed = number(summary.failed) ?? 0;
  words.findings.push(`${plural(number(summary.cases) ?? result.rows.length, "case")} computed.`);
  if (failed > 0) words.warnings.push(`${plural(failed, "case")} failed; the table's last column says why.`);
  const reused = number(summary.reused) ?? 0;
  if (reused > 0) words.basis.push(`${plural(reused, "case")} came from an earlier run.`);
}

/** The summary of any kind of study; for unknown kinds, only their warning. */
export function wordsOf(result: StudyResult): Words {
  const words: Words = { warnings: [], findings: [], winners: [], basis: [], refused: [] };
  const tell: Record<string, (result: StudyResult, words: Words) => void> = { work_precision: workPrecision, convergence, stability, cross_check: crossCheck, sweep };
  if (text(result.summary.warning)) words.warnings.push(text(result.summary.warning));
  tell[text(result.summary.kind)]?.(result, words);
  words.basis.unshift(...reference(result.summary));
  const sentence = (s: string): string => s.charAt(0).toUpperCase() + s.slice(1) + (/[.!?]$/.test(s) ? "" : ".");
  words.warnings = words.warnings.map(sentence);
  return words;
}
