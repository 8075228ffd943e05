// Keyboard shortcuts. Elements name theirs in aria-keyshortcuts, so that page and keys agree.
import { byId } from "./dom";

const buttons: Record<string, string> = {
  " ": "play", ".": "step", r: "reset", f: "camera", "1": "show-points", "2": "show-lines", "3": "show-surface",
  c: "show-speed", k: "show-contacts", j: "show-joints", m: "show-side", g: "toggle-panel", "?": "show-help", l: "theme", o: "view-follow", x: "view-side", y: "view-top", z: "view-front",
};

export interface KeyActions {
  step(steps: number): void;
  faster(by: 1 | -1): void;
  editor(): void;
  escape(): void;
}

export function installShortcuts(actions: KeyActions): void {
  // A button clicked with the mouse gives up the focus, or Space would press it again.
  document.addEventListener("click", (event) => {
    if (event.detail > 0) (event.target as Element).closest("button")?.blur();
  });
  document.addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey || /^(TEXTAREA|INPUT|SELECT)$/.test(target.tagName)) return;
    if (byId<HTMLDialogElement>("help").open) return;
    // A button focused by the keyboard answers to Space itself.
    if (event.key === " " && target.tagName === "BUTTON") return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (event.code === "Period" && event.shiftKey) actions.step(10);
    else if (key === "[") actions.faster(-1);
    else if (key === "]") actions.faster(1);
    else if (key === "e") actions.editor();
    else if (key === "Escape") actions.escape();
    else if (buttons[key]) {
      const button = byId<HTMLButtonElement>(buttons[key]);
      // Buttons in a closed menu respond to their keys as well.
      if (!button.disabled && (button.offsetParent !== null || button.closest("#views"))) button.click();
    } else return;
    event.preventDefault();
  });
}
