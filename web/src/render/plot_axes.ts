// The axes of a scene that draws its equations as a plot: a frame around what was seen, round values on its sides,
// and names.
import { Group, type IUniform } from "three";
import type { PlotAxis } from "../client/gen/truestep/v1/stream_pb";
import { axisOf, placeOf } from "./axis_ticks";
import type { Extent } from "./extent";
import type { Label } from "./labels";
import { WideLines } from "./lines";
import { scenery } from "./shading";

const kTicks = 5;

export class PlotAxes {
  readonly object = new Group();
  labels: Label[] = [];
  private readonly frame: WideLines;
  private readonly grid: WideLines;

  constructor(
    private readonly axes: PlotAxis[],
    private readonly duration: number | undefined,
    viewHeight: IUniform<number>,
  ) {
    this.frame = new WideLines(viewHeight, { pixels: 1.3, radius: 0, opacity: 0.8, tube: false });
    this.grid = new WideLines(viewHeight, { pixels: 1.2, radius: 0, opacity: 0.22, tube: false });
    this.object.add(this.grid.object, this.frame.object);
  }

  /** Adds the ends of a time axis, since the run's length is known in advance, and the frame's corners. */
  reachOf(out: Extent): void {
    const { axes, duration } = this;
    if (out.empty) return;
    const [low, high] = [out.ball().center, out.ball().center];
    axes.forEach((shown, axis) => {
      if (shown.name !== "t" || duration === undefined) return;
      low[axis] = placeOf(shown, 0);
      high[axis] = placeOf(shown, duration);
      if (!Number.isFinite(low[axis]! + high[axis]!)) return;
      out.add(...low);
      out.add(...high);
    });
    const [x, y, z] = [0, 1, 2].map((axis) => out.along(axis)) as [[number, number], [number, number], [number, number]];
    // What has hardly changed yet is no line on the edge of the paper: the frame is at least a third as high as wide.
    const missing = (x[1] - x[0]) / 3 - (y[1] - y[0]);
    if (missing > 0) [y[0], y[1]] = [y[0] - 0.5 * missing, y[1] + 0.5 * missing];
    for (let corner = 0; corner < 8; ++corner) out.add(x[corner & 1]!, y[(corner >> 1) & 1]!, z[corner >> 2]!);
  }

  /** Draws the axes of what was seen. */
  fit(seen: Extent): void {
    const { axes } = this;
    const sides = [0, 1, 2].map((axis) => {
      const [low, high] = seen.along(axis);
      const room = 0.04 * (high - low || 1);
      return [low - room, high + room] as const;
    });
    const [x, y, z] = sides as [readonly [number, number], readonly [number, number], readonly [number, number]];
    const solid = axes.length > 2;
    const depth = solid ? z[0] : 0;
    const frame: number[] = [];
    const grid: number[] = [];
    this.labels = [];
    const line = (to: number[], ...ends: number[]): void => void to.push(...ends);
    const horizontal = axisOf(axes[0]!, x[0], x[1], kTicks);
    const vertical = axisOf(axes[1]!, y[0], y[1], kTicks);
    for (const { at, label } of horizontal.ticks) {
      line(grid, at, y[0], depth, at, y[1], depth);
      this.labels.push({ text: label, at: [at, y[0], solid ? z[1] : 0], kind: "tick-x" });
    }
    for (const { at, label } of vertical.ticks) {
      line(grid, x[0], at, depth, x[1], at, depth);
      this.labels.push({ text: label, at: [x[0], at, depth], kind: "tick-y" });
    }
    line(frame, x[0], y[0], depth, x[1], y[0], depth);
    line(frame, x[0], y[0], depth, x[0], y[1], depth);
    this.labels.push({ text: horizontal.label, at: [x[1], y[0], solid ? z[1] : 0], kind: "axis" });
    this.labels.push({ text: vertical.label, at: [x[0], y[1], depth], kind: "axis" });
    if (solid) {
      const away = axisOf(axes[2]!, z[0], z[1], kTicks);
      for (const { at, label } of away.ticks) {
        line(grid, x[0], y[0], at, x[1], y[0], at);
        this.labels.push({ text: label, at: [x[1], y[0], at], kind: "tick-x" });
      }
      for (const { at } of horizontal.ticks) line(grid, at, y[0], z[0], at, y[0], z[1]);
      line(frame, x[1], y[0], z[0], x[1], y[0], z[1]);
      line(frame, x[0], y[0], z[1], x[1], y[0], z[1]);
      this.labels.push({ text: away.label, at: [x[1], y[0], z[0]], kind: "axis" });
    }
    this.frame.set(frame);
    this.grid.set(grid);
    this.frame.colorAll(scenery.ink);
    this.grid.colorAll(scenery.ink);
  }

  dispose(): void {
    this.frame.dispose();
    this.grid.dispose();
    this.object.removeFromParent();
  }
}
