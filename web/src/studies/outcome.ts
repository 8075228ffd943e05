// The right-hand side of the page: a study's progress, then its findings.
import type { Operation, StudyResult } from "../client/studies";
import { byId, icon, make } from "../ui/dom";
import { makeFigure, type Figure } from "./figure";
import { modelOf, rowOf } from "./model";
import { cellText, duration, heading, quantity } from "./numbers";
import { makeTable } from "./table";
import { titleOf, wordsOf, type Words } from "./words";

type Part = "empty" | "progress" | "result";

export class Outcome {
  private figure: Figure | undefined;
  private begun = 0;
  private clock: ReturnType<typeof setInterval> | undefined;

  show(part: Part): void {
    for (const one of ["empty", "progress", "result"] as const) byId(one).hidden = one !== part;
    clearInterval(this.clock);
    if (part !== "progress") return;
    this.begun = performance.now();
    const tick = (): void => void (byId("elapsed").textContent = duration(Math.floor((performance.now() - this.begun) / 1000)));
    tick();
    this.clock = setInterval(tick, 1000);
  }

  progress(operation: Operation): void {
    const percent = Math.round(100 * Math.min(1, Math.max(0, operation.progress)));
    byId("progress-title").textContent = titleOf(operation.kind);
    byId<HTMLProgressElement>("progress-bar").value = percent;
    byId("progress-percent").textContent = `${percent} %`;
    byId("progress-note").textContent = noteOf(operation);
  }

  result(operation: Operation, result: StudyResult): void {
    this.figure?.close();
    const model = modelOf(result);
    const words = wordsOf(result);
    this.figure = makeFigure(model, (curve, point) => {
      const row = rowOf(result, model, curve, point);
      if (!row) return [[model.xLabel, unitText(point.x, model.xUnit)], [model.yLabel, unitText(point.y, model.yUnit)]];
      return result.columns.filter(({ name }) => row[name] !== null && row[name] !== undefined && name !== "integrator" && !(name === "status" && row[name] === "ok")).map(({ name, unit }) => [heading(name), cellText(row[name], unit)]);
    });
    const scene = typeof result.summary.scene === "string" ? result.summary.scene.replaceAll("_", " ") : "";
    const link = (href: string | undefined, name: string, file: string): HTMLElement => make("a", { class: "button small", href: href ?? "", download: `${operation.kind}.${file}`, "aria-label": `Download as ${name}` }, icon("download"), name);
    const head = make("header", { class: "result-head" },
      make("div", {}, make("h2", { tabindex: "-1" }, titleOf(operation.kind)), make("p", {}, scene)),
      make("nav", { "aria-label": "Downloads" }, link(operation.links.svg, "SVG", "svg"), link(operation.links.csv, "CSV", "csv"), link(operation.links.result, "JSON", "json")));
    const plot = model.curves.length > 0 ? this.figure.element : make("p", { class: "empty" }, "There is nothing to draw: no run gave a value. The table says why.");
    byId("result").replaceChildren(head, ...warnings(words), sheet("plot-sheet", plot), ...said(words), sheet("table-sheet", makeTable(result)));
    this.show("result");
  }
}

const sheet = (name: string, ...children: HTMLElement[]): HTMLElement => make("section", { class: `sheet ${name}` }, ...children);
const unitText = (value: number, unit: string): string => (unit === "s" ? duration(value) : `${quantity(value)}${unit ? ` ${unit}` : ""}`);

function noteOf(operation: Operation): string {
  if (operation.status === "waiting") return "waiting for another study to end";
  if (operation.note === "reference") return "computing the reference solution";
  if (operation.note === "") return "starting";
  return /^\w+$/.test(operation.note) ? `measuring ${operation.note}` : operation.note;
}

const warnings = (words: Words): HTMLElement[] => words.warnings.map((text) => make("p", { class: "warning-line", role: "alert" }, icon("warning"), make("span", {}, text)));

/** The answer with the cheapest method at each error, and how it was measured. */
function said(words: Words): HTMLElement[] {
  const parts: HTMLElement[] = words.findings.map((text) => make("p", { class: "finding" }, text));
  if (words.winners.length > 0) {
    const rows = words.winners.map((winner) => make("tr", {}, make("td", {}, winner.error), make("td", {}, make("b", {}, winner.method)), make("td", { class: "number" }, duration(winner.seconds))));
    parts.push(make("table", { class: "winners" }, make("thead", {}, make("tr", {}, make("th", { scope: "col" }, "error"), make("th", { scope: "col" }, "cheapest method"), make("th", { scope: "col", class: "number" }, "CPU time"))), make("tbody", {}, ...rows)));
  }
  const basis: HTMLElement[] = words.basis.map((text) => make("p", { class: "basis" }, text));
  if (words.refused.length > 0) {
    basis.push(make("details", { class: "more" }, make("summary", {}, words.refused.length === 1 ? "1 method does not suit this scene" : `${words.refused.length} methods do not suit this scene`), make("ul", {}, ...words.refused.map(({ method, reason }) => make("li", {}, make("b", {}, method), ` ${reason}`)))));
  }
  if (parts.length + basis.length === 0) return [];
  const how = basis.length > 0 ? [make("div", { class: "how" }, make("h3", {}, "How it was measured"), ...basis)] : [];
  return [sheet("words", make("div", { class: "answer" }, ...parts), ...how)];
}
