// Names on the picture: elements that follow positions in the scene. They are page text, so that they are sharp and
// accessible to screen readers.
import { Vector3, type PerspectiveCamera } from "three";

export interface Label {
  text: string;
  at: [number, number, number];
  /** "name" of a system, "tick" or "axis" of a plot. */
  kind: "name" | "tick-x" | "tick-y" | "axis";
  color?: string;
}

export class Labels {
  private readonly host: HTMLElement;
  private readonly elements: HTMLElement[] = [];
  private labels: Label[] = [];
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
      if (element.textContent !== text) element.textContent = text;
      if (element.dataset.kind !== kind) element.dataset.kind = kind;
      element.style.setProperty("--mark", color ?? "transparent");
    });
  }

  /** Moves every label to its position on a screen of this size. */
  place(camera: PerspectiveCamera, width: number, height: number): void {
    this.labels.forEach(({ at }, k) => {
      const p = this.point.fromArray(at).project(camera);
      const element = this.elements[k]!;
      const seen = p.z > -1 && p.z < 1 && Math.abs(p.x) < 1.1 && Math.abs(p.y) < 1.1;
      element.style.visibility = seen ? "visible" : "hidden";
      if (seen) element.style.transform = `translate(${(((p.x + 1) / 2) * width).toFixed(1)}px, ${(((1 - p.y) / 2) * height).toFixed(1)}px)`;
    });
  }
}
