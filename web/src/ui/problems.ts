// Problems as readable cards: what happened, where in the input, what would have been allowed.
import type { Issue, Problem } from "../client/problem";
import { brief, byId, icon, make } from "./dom";

/** One issue as a list item; `onShow` goes to its pointer, `onFix` inserts the suggested name there. */
export function issueItem(issue: Issue, onShow?: (issue: Issue) => void, onFix?: (issue: Issue) => void): HTMLElement {
  const pointer = make(onShow ? "button" : "code", { class: "pointer", ...(onShow ? { type: "button", title: "Show it in the scene", onclick: () => onShow(issue) } : {}) }, issue.pointer === "" ? "(whole scene)" : issue.pointer);
  const item = make("li", { class: "issue" }, pointer);
  const text = issue.message || issue.code.replaceAll("_", " ");
  item.append(make("p", {}, text));
  const facts = make("dl", {});
  const fact = (name: string, value: unknown): void => {
    if (value !== undefined && value !== "" && value !== null) facts.append(make("div", {}, make("dt", {}, name), make("dd", {}, brief(value))));
  };
  fact("value", issue.value);
  fact("allowed", Array.isArray(issue.allowed) ? issue.allowed.map(brief).join(", ") : issue.allowed);
  fact("unit", issue.unit);
  if (!onFix) fact("did you mean", issue.did_you_mean);
  if (facts.childElementCount > 0) item.append(facts);
  if (onFix && issue.did_you_mean) item.append(make("button", { class: "fix", type: "button", onclick: () => onFix(issue) }, "Use ", make("code", {}, issue.did_you_mean)));
  return item;
}

/** A computed number needs no more digits than a person would type. */
const rounded = (value: unknown): string => (typeof value === "number" ? String(+value.toPrecision(4)) : brief(value));

/** What would help, one item per remedy; undefined when the problem names none. */
function remedyList(problem: Problem): HTMLElement | undefined {
  const remedies = problem.remedies;
  if (!Array.isArray(remedies) || remedies.length === 0) return undefined;
  return make("section", { class: "remedies" }, make("h3", {}, "What would help"), make("ul", {}, ...remedies.map((remedy) => make("li", {}, String(remedy)))));
}

/** What a card offers to do about its problem. */
export interface Action {
  label: string;
  run: () => void;
}

/** Numbers that a card states besides its sentence, and their units. */
const facts: Record<string, string> = { last_good_step: "", suggested_dt: " s", suggested_integrator: "", limit: "", estimate: "" };

/** Shows a card for `problem`; the same problem again replaces its card. */
export function showProblem(problem: Problem, tone: "error" | "warning" = "error", actions: Action[] = []): void {
  const list = byId("problems");
  const key = `${problem.code} ${problem.detail ?? ""}`;
  for (const old of [...list.children]) if ((old as HTMLElement).dataset.key === key) old.remove();
  while (list.childElementCount > 2) list.firstElementChild?.remove();
  const card: HTMLElement = make("article", { class: `card ${tone}`, role: "alert" });
  card.dataset.key = key;
  const head = make("header", {}, make("h2", {}, problem.title));
  if (problem.status > 0) head.append(make("span", { class: "status" }, String(problem.status)));
  head.append(make("button", { class: "icon-button small", "aria-label": "Close", onclick: () => card.remove() }, icon("close")));
  card.append(head);
  const remedies = remedyList(problem);
  // The service's sentence ends with the remedies; here they have their own list.
  const detail = remedies ? problem.detail?.replace(/; try .*$/s, "") : problem.detail;
  if (detail && detail !== problem.title) card.append(make("p", {}, detail));
  if (remedies) card.append(remedies);
  const extras = Object.keys(facts).filter((name) => problem[name] !== undefined);
  if (extras.length > 0) card.append(make("dl", { class: "extras" }, ...extras.map((name) => make("div", {}, make("dt", {}, name.replaceAll("_", " ")), make("dd", {}, `${rounded(problem[name])}${facts[name]}`)))));
  if (actions.length > 0) card.append(make("p", { class: "actions" }, ...actions.map(({ label, run }) => make("button", { class: "fix", type: "button", onclick: run }, label))));
  const issues = [...(problem.errors ?? []), ...(problem.suggestions ?? [])];
  if (issues.length > 0) card.append(make("ul", { class: "issues" }, ...issues.slice(0, 12).map((issue) => issueItem(issue))));
  if (problem.trace_id) card.append(make("p", { class: "trace" }, `trace ${problem.trace_id}`));
  list.append(card);
}

/** Takes back cards of a problem that is over. */
export function dismissProblems(code: string): void {
  for (const card of [...byId("problems").children]) if ((card as HTMLElement).dataset.key?.startsWith(`${code} `)) card.remove();
}

export function clearProblems(): void {
  byId("problems").replaceChildren();
}
