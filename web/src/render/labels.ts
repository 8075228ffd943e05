// Names on the picture: elements that follow positions in the scene. They are page text, so that they are sharp and
// accessible to screen readers.
import { Vector3, type PerspectiveCamera } from "three";

const kMargin = 10; // px beside the name of an axis

export interface Label {
  text: string;
  at: [number, number, number];
  /** "name" of a system, of a "row", "tick" or "axis" of a plot. */
  kind: "name" | "row" | "tick-x" | "tick-y" | "axis";
  color?: string;
}

export class Labels {
  private readonly host: HTMLElement;
  private readonly elements: HTMLElement[] = [];
  private labels: Label[] = [];
  /** px; measured when a label is first placed. */
  private readonly widths: (number | undefined)[] = [];
  private readonly point = new Vector3();

  constructor(canvas: HTMLCanvasElement) {
    this.host = document.createElement("div");
    this.host.className = "labels";
    canvas.after(this.host);
  }

  set(labels: Label[]): void {
    this.labels = labels;
    while (this.elements.length > labels.length) this.elements.pop()!.remove();
    labels.forEach(({ text, kind, color }, k) => {
      const element = (this.elements[k] ??= this.host.appendChild(document.createElement("span")));
      if (element.textContent !== text) {
        element.textContent = text;
        this.widths[k] = undefined;
      }
      if (element.dataset.kind !== kind) element.dataset.kind = kind;
      element.style.setProperty("--mark", color ?? "transparent");
    });
  }

  /** Moves every label to its position on a screen of this size. */
  place(camera: PerspectiveCamera, width: number, height: number): void {
    this.labels.forEach(({ at, kind }, k) => {
      const p = this.point.fromArray(at).project(camera);
      const element = this.elements[k]!;
      const seen = p.z > -1 && p.z < 1 && Math.abs(p.x) < 1.1 && Math.abs(p.y) < 1.1;
      element.style.visibility = seen ? "visible" : "hidden";
      if (!seen) return;
      let x = ((p.x + 1) / 2) * width;
      // The name of an axis that ends at the window's edge stays inside.
      if (kind === "axis") x = Math.min(x, width - (this.widths[k] ??= element.offsetWidth) - kMargin);
      element.style.transform = `translate(${x.toFixed(1)}px, ${(((1 - p.y) / 2) * height).toFixed(1)}px)`;
    });
  }
}
