// What goes wrong, as cards: warnings, instabilities, refusals and faults of the page.
import { ProblemError, problemOf } from "../client/problem";
import type { Instability } from "../client/rest";
import { showProblem, type Action } from "./problems";

export function warn(detail: string): void {
  showProblem({ title: "Warning", status: 0, code: "warning", detail }, "warning");
}

/** What an event of the session says to its readers. */
export function tell({ kind, detail }: { kind: string; detail: string }): void {
  if (kind === "warning") warn(detail);
  else if (/error|fail|full|incomplete/.test(kind)) showProblem({ title: kind.replaceAll("_", " "), status: 0, code: kind, detail });
}

/** Why the session stands at its last good step, and what can be done about it. */
export function unstable({ detail, last_good_step, suggested_dt, remedies }: Instability, actions: Action[]): void {
  showProblem({ title: "The simulation became unstable", status: 0, code: "instability", detail, last_good_step, suggested_dt, remedies }, "error", actions);
}

export function fail(error: unknown): void {
  if (!(error instanceof ProblemError)) console.error(error);
  const problem = problemOf(error);
  // The connection line already says so, and the next attempt is under way.
  if (problem.code !== "connection_lost") showProblem(problem);
}
