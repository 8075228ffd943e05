// What goes wrong, as cards: warnings, instabilities, refusals and faults of the page.
import { ProblemError, problemOf } from "../client/problem";
import type { Instability } from "../client/rest";
import { showProblem } from "./problems";

export function warn(detail: string): void {
  showProblem({ title: "Warning", status: 0, code: "warning", detail }, "warning");
}

export function unstable(instability: Instability): void {
  showProblem({ title: "The simulation became unstable", status: 0, code: "instability", ...instability });
}

export function fail(error: unknown): void {
  if (!(error instanceof ProblemError)) console.error(error);
  const problem = problemOf(error);
  // The connection line already says so, and the next attempt is under way.
  if (problem.code !== "connection_lost") showProblem(problem);
}
