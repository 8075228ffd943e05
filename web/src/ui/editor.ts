// The scene editor: JSON text with line numbers, the service's findings below it, and a link from each finding to its
// lines. Text that is not JSON is caught here, before it is sent.
import type { Issue } from "../client/problem";
import { ProblemError, problemOf } from "../client/problem";
import { locate } from "../client/locate";
import type { Scene, Service } from "../client/rest";
import { byId, make } from "./dom";
import { issueItem } from "./problems";

/** What the editor opens with: small, and it runs. */
const starter: Scene = {
  schema_version: "1.0",
  name: "my scene",
  gravity: [0, -9.81, 0],
  time: { dt: 0.005, duration: 10 },
  systems: [{ type: "mass_spring", id: "rope", rope: { from: [0, 1, 0], to: [1, 1, 0], links: 20 }, mass: 0.01, stiffness: 1000, damping: 0.05, pinned: ["first"] }],
};

export class Editor {
  private readonly text = byId<HTMLTextAreaElement>("scene-text");
  private readonly gutter = byId("gutter");
  private readonly findings = byId("findings");
  private timer: ReturnType<typeof setTimeout> | undefined;
  private marked = new Set<number>();

  constructor(
    private readonly service: Service,
    private readonly create: (scene: Scene) => Promise<void>,
  ) {
    this.set(starter);
    this.text.addEventListener("input", () => this.edited());
    this.text.addEventListener("scroll", () => (this.gutter.scrollTop = this.text.scrollTop));
    this.text.addEventListener("keydown", (event) => {
      if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) void this.run();
      event.stopPropagation();
    });
    byId("validate").addEventListener("click", () => void this.validate());
    byId("create").addEventListener("click", () => void this.run());
  }

  /** Replaces the text by `scene`. */
  set(scene: Scene): void {
    this.text.value = pretty(scene);
    this.text.scrollTop = 0;
    this.say();
    this.number([]);
  }

  private edited(): void {
    this.number([]);
    clearTimeout(this.timer);
    this.timer = setTimeout(() => void this.validate(), 600);
  }

  /** The scene in the text, or undefined after reporting where it stops being JSON. */
  private parse(): Scene | undefined {
    try {
      return JSON.parse(this.text.value) as Scene;
    } catch (error) {
      const message = error instanceof Error ? error.message : String(error);
      const offset = Number(/position (\d+)/.exec(message)?.[1] ?? Number.NaN);
      const line = Number.isNaN(offset) ? undefined : this.lineOf(offset);
      this.say(make("p", { class: "bad" }, line === undefined ? `This is not valid JSON yet: ${message}` : `Line ${line + 1} is not valid JSON yet: ${message}`));
      this.number(line === undefined ? [] : [line]);
      return undefined;
    }
  }

  private async validate(): Promise<void> {
    const scene = this.parse();
    if (!scene) return;
    try {
      const { errors = [], warnings = [], suggestions = [] } = await this.service.validate(scene);
      this.list(errors, [...warnings, ...suggestions]);
    } catch (error) {
      this.refused(error);
    }
  }

  private async run(): Promise<void> {
    const scene = this.parse();
    if (!scene) return;
    clearTimeout(this.timer);
    try {
      await this.create(scene);
      this.say(make("p", { class: "good" }, "Running."));
    } catch (error) {
      this.refused(error);
    }
  }

  private refused(error: unknown): void {
    const problem = problemOf(error);
    if (error instanceof ProblemError && problem.errors?.length) return this.list(problem.errors, problem.warnings ?? []);
    this.say(make("p", { class: "bad" }, problem.detail ?? problem.title));
  }

  private list(errors: Issue[], warnings: Issue[]): void {
    const show = (issue: Issue): void => this.select(issue.pointer);
    if (errors.length + warnings.length === 0) {
      this.say(make("p", { class: "good" }, "The scene is valid."));
    } else {
      const title = errors.length > 0 ? `${errors.length} ${errors.length === 1 ? "value needs" : "values need"} a change` : "Valid, with remarks";
      this.say(
        make("p", { class: errors.length > 0 ? "bad" : "good" }, title),
        make("ul", { class: "issues" }, ...[...errors, ...warnings].map((issue) => issueItem(issue, show, (wrong) => this.fix(wrong)))),
      );
    }
    const lines = errors.flatMap((issue) => {
      const range = locate(this.text.value, issue.pointer);
      return range ? [this.lineOf(range.start)] : [];
    });
    this.number(lines);
  }

  /** Selects the value at a pointer and scrolls to it. */
  private select(pointer: string): void {
    const range = locate(this.text.value, pointer);
    if (!range) return;
    this.text.focus();
    this.text.setSelectionRange(range.start, range.end);
    const height = this.text.scrollHeight / this.text.value.split("\n").length;
    this.text.scrollTop = Math.max(0, (this.lineOf(range.start) - 3) * height);
  }

  /** Replaces the unknown key or value by the suggested name. */
  private fix(issue: Issue): void {
    const range = locate(this.text.value, issue.pointer);
    if (!range || !issue.did_you_mean) return;
    const before = this.text.value.slice(range.start, range.end);
    const name = JSON.stringify(issue.did_you_mean);
    const after = issue.code.includes("key") ? before.replace(/^"(?:[^"\\]|\\.)*"/, name) : before.replace(/"(?:[^"\\]|\\.)*"\s*$/, name);
    this.text.focus();
    this.text.setRangeText(after, range.start, range.end, "select");
    void this.validate();
  }

  private lineOf(offset: number): number {
    return this.text.value.slice(0, offset).split("\n").length - 1;
  }

  private say(...content: Node[]): void {
    this.findings.replaceChildren(...content);
  }

  private number(bad: number[]): void {
    this.marked = new Set(bad);
    const lines = this.text.value.split("\n").length;
    this.gutter.replaceChildren(
      ...Array.from({ length: lines }, (_, k) => make("span", this.marked.has(k) ? { class: "marked" } : {}, String(k + 1))),
    );
    this.gutter.scrollTop = this.text.scrollTop;
  }
}

/** JSON with arrays of numbers and other short values on one line. */
function pretty(value: unknown, indent = ""): string {
  const flat = JSON.stringify(value);
  if (typeof value !== "object" || value === null) return flat;
  if (indent !== "" && flat.length <= 60) return flat.replace(/,(?=["\d[{-])/g, ", ").replace(/":/g, '": ');
  const inner = `${indent}  `;
  const rows = Array.isArray(value)
    ? value.map((item) => inner + pretty(item, inner))
    : Object.entries(value).map(([key, item]) => `${inner}${JSON.stringify(key)}: ${pretty(item, inner)}`);
  if (rows.length === 0) return flat;
  const [open, close] = Array.isArray(value) ? ["[", "]"] : ["{", "}"];
  return `${open}\n${rows.join(",\n")}\n${indent}${close}`;
}
