// The buttons of the page: what each of them does, and which of them are pressed.
import type { Side } from "../render/framing";
import type { Visibility } from "../render/system_view";
import { byId } from "./dom";

export type Switch = "points" | "lines" | "surface" | "bySpeed";
export type Mark = "contacts" | "joints";

export interface Controls {
  playOrPause(): void;
  step(): void;
  reset(): void;
  /** Shows the whole scene, from its own side or another. */
  look(side: Side): void;
  follow(): void;
  theme(): void;
  /** A switch has changed in `show`. */
  shown(key: Switch): void;
  /** A mark has changed in `marks`. */
  marked(): void;
  panel(which: "gallery" | "editor" | "none"): void;
  layout(): void;
  /** The page is being left. */
  left(): void;
}

function pressed(id: string, on: boolean): void {
  byId(id).setAttribute("aria-pressed", String(on));
}

export function installControls(controls: Controls, show: Pick<Visibility, Switch>, marks: Record<Mark, boolean>): void {
  const click = (id: string, action: () => void): void => byId(id).addEventListener("click", action);
  click("play", () => controls.playOrPause());
  click("step", () => controls.step());
  click("reset", () => controls.reset());
  click("camera", () => controls.look("scene"));
  for (const side of ["front", "side", "top"] as const) click(`view-${side}`, () => controls.look(side));
  click("view-follow", () => controls.follow());
  click("theme", () => controls.theme());
  const views = byId<HTMLDetailsElement>("views");
  document.addEventListener("pointerdown", (event) => !views.contains(event.target as Node) && (views.open = false));
  addEventListener("pagehide", () => controls.left());
  const toggle = (id: string, key: Switch): void =>
    click(id, () => {
      show[key] = !show[key];
      pressed(id, show[key]);
      controls.shown(key);
    });
  toggle("show-points", "points");
  toggle("show-lines", "lines");
  toggle("show-surface", "surface");
  toggle("show-speed", "bySpeed");
  const mark = (id: string, key: Mark): void =>
    click(id, () => {
      marks[key] = !marks[key];
      pressed(id, marks[key]);
      controls.marked();
    });
  mark("show-contacts", "contacts");
  mark("show-joints", "joints");
  const side = byId("side");
  const measurements = (on: boolean): void => {
    side.hidden = !on;
    pressed("show-side", on);
    controls.layout();
  };
  click("show-side", () => measurements(side.hidden));
  // A phone shows what the scene is about on request, among the measurements.
  click("show-lesson", () => {
    const on = side.hidden || !side.classList.contains("told");
    side.classList.toggle("told", on);
    pressed("show-lesson", on);
    measurements(on || !side.hidden);
  });
  click("toggle-panel", () => controls.panel(byId("panel").hidden ? "gallery" : "none"));
  click("close-panel", () => controls.panel("none"));
  click("tab-gallery", () => controls.panel("gallery"));
  click("tab-editor", () => controls.panel("editor"));
  click("show-help", () => byId<HTMLDialogElement>("help").showModal());
  const layout = new ResizeObserver(() => controls.layout());
  for (const id of ["app", "side", "panel"]) layout.observe(byId(id));
}

/** The play button shows what it would do. */
export function showPlaying(playing: boolean): void {
  const button = byId("play");
  button.querySelector("use")?.setAttribute("href", playing ? "#i-pause" : "#i-play");
  button.setAttribute("aria-label", playing ? "Pause" : "Play");
  button.title = playing ? "Pause (Space)" : "Play (Space)";
}
