// What the page shows around the picture: panels, titles, the state of the connection, switches and hints.
import type { Stage } from "../render/stage";
import { accuracyWords, type Accuracy } from "../studies/accuracy";
import { byId } from "./dom";

const stateText = { connecting: "connecting", open: "live", waiting: "connection lost, trying again", closed: "closed" } as const;

export class Page {
  private hintTimer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly stage: Stage) {}

  panel(which: "gallery" | "editor" | "none"): void {
    byId("panel").hidden = which === "none";
    byId("gallery").hidden = which !== "gallery";
    byId("editor").hidden = which !== "editor";
    byId("tab-gallery").setAttribute("aria-selected", String(which === "gallery"));
    byId("tab-editor").setAttribute("aria-selected", String(which === "editor"));
    byId("app").dataset.panel = which;
    if (which === "editor") byId("scene-text").focus({ preventScroll: true });
    this.layout();
  }

  /** Tells the stage which part of the picture the panels leave free. */
  layout(): void {
    const box = (id: string): DOMRect => byId(id).getBoundingClientRect();
    const panel = box("panel");
    const side = box("side");
    const controls = box("transport");
    const bottom = controls.height === 0 ? 0 : window.innerWidth <= 720 ? window.innerHeight - controls.top + 12 : 90;
    const running = document.body.classList.contains("running");
    if (window.innerWidth <= 720) {
      this.stage.setInset({ left: 0, right: 0, top: running && side.height > 0 ? side.bottom : 56, bottom: running ? Math.max(panel.height, bottom) : 0 });
    } else {
      this.stage.setInset({ left: running && panel.width > 0 ? panel.right : 0, right: running && side.width > 0 ? window.innerWidth - side.left : 0, top: 50, bottom });
    }
  }

  /** A run that is only watched has no controls of its time. */
  watching(on: boolean): void {
    document.body.classList.toggle("watching", on);
    byId<HTMLInputElement>("seek").disabled = on;
    byId("watching").hidden = !on;
  }

  title(text: string): void {
    byId("title").textContent = text;
    document.title = text ? `${text} · Truestep` : "Truestep";
  }

  lesson(text: string | undefined): void {
    const lesson = byId("lesson");
    lesson.hidden = !text;
    lesson.textContent = text ?? "";
    byId("show-lesson").hidden = !text;
  }

  /** Shows the method that was chosen for a requested accuracy. */
  accuracy(report: Accuracy | undefined): void {
    const line = byId("accuracy");
    line.hidden = !report;
    line.textContent = report ? accuracyWords(report) : "";
  }

  connection(state: keyof typeof stateText): void {
    const line = byId("connection");
    line.dataset.state = state;
    line.querySelector("span")!.textContent = stateText[state];
  }

  hint(text: string): void {
    const hint = byId("hint");
    hint.textContent = text;
    hint.hidden = false;
    clearTimeout(this.hintTimer);
    this.hintTimer = setTimeout(() => (hint.hidden = true), 1600);
  }

  /** Shows only the switches that have an effect in this scene. */
  toggles(): void {
    const { points, lines, surface, bodies } = this.stage.has;
    byId("show-points").hidden = !points;
    const { bySpeed, colorBy } = this.stage.show;
    byId("show-speed").hidden = !this.stage.colorable || (!points && !bodies && !((lines || surface) && colorBy));
    byId("show-speed").setAttribute("aria-pressed", String(bySpeed));
    byId("show-contacts").hidden = byId("show-joints").hidden = !bodies;
    byId("show-lines").hidden = !lines;
    byId("show-surface").hidden = !surface;
  }
}
