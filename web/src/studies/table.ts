// The rows of a study as a table that sorts by any column.
import type { Cell, Row, StudyResult } from "../client/studies";
import { make } from "../ui/dom";
import { cellText, heading } from "./numbers";

/** Rows by one column, numbers before texts, missing values last; rows that tie keep their order. */
export function sorted(rows: readonly Row[], column: string, direction: 1 | -1): Row[] {
  const rank = (cell: Cell): number => (typeof cell === "number" ? 0 : typeof cell === "string" ? 1 : 2);
  const compare = (a: Cell, b: Cell): number => {
    if (rank(a) !== rank(b)) return rank(a) - rank(b);
    if (typeof a === "number" && typeof b === "number") return direction * (a - b);
    return direction * String(a ?? "").localeCompare(String(b ?? ""));
  };
  return [...rows].sort((a, b) => compare(a[column], b[column]));
}

export function makeTable(result: StudyResult): HTMLElement {
  const body = make("tbody", {});
  const numeric = new Set(result.columns.filter((column) => result.rows.some((row) => typeof row[column.name] === "number")).map((column) => column.name));
  const fill = (rows: readonly Row[]): void =>
    body.replaceChildren(
      ...rows.map((row) =>
        make("tr", {}, ...result.columns.map(({ name, unit }) => {
          const exact = row[name];
          const cell = make("td", numeric.has(name) ? { class: "number", title: String(exact ?? "") } : {}, cellText(exact, unit, name));
          if (name === "status" && exact !== "ok") cell.classList.add("aside");
          return cell;
        })),
      ),
    );
  const headings = result.columns.map(({ name, unit }) => {
    const button = make("button", { type: "button", title: "Sort by this column" }, heading(name));
    if (unit !== "" && unit !== "1" && (unit !== "s" || name === "time")) button.append(make("small", {}, ` ${unit}`));
    const cell: HTMLElement = make("th", { scope: "col", class: numeric.has(name) ? "number" : "" }, button);
    button.addEventListener("click", () => {
      const up = cell.getAttribute("aria-sort") !== "ascending";
      for (const other of headings) other.removeAttribute("aria-sort");
      cell.setAttribute("aria-sort", up ? "ascending" : "descending");
      fill(sorted(result.rows, name, up ? 1 : -1));
    });
    return cell;
  });
  fill(result.rows);
  const caption = make("caption", { class: "visually-hidden" }, `${result.plot.title}, ${result.rows.length} rows`);
  return make("div", { class: "table-scroll", tabindex: "0", role: "region", "aria-label": "Table of the study" }, make("table", { id: "rows" }, caption, make("thead", {}, make("tr", {}, ...headings)), body));
}
