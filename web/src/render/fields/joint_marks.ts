// Contacts and joints as they are drawn, joints in the colours of their values.
import type { Marks } from "../../client/gen/truestep/v1/stream_pb";
import { JointValues } from "./joint_values";
import { balanced } from "./scheme";
import { eachJointEnd, MarkLines } from "../marks";
import type { Visibility } from "../system_view";
import { widest } from "../value_range";

export class JointMarks extends JointValues {
  private readonly lines = new MarkLines();
  private marked: Marks | undefined;

  get object(): MarkLines["object"] {
    return this.lines.object;
  }

  /** What is drawn from now on; undefined: nothing. */
  mark(marks: Marks | undefined): void {
    this.marked = marks;
  }

  /** Draws it; `radius` is that of everything on the screen. */
  draw(show: Visibility, radius: number): void {
    const colors = this.marked ? this.colors(this.marked, show.scheme.map, this.shownRange(show) ?? [0, 1]) : [];
    this.lines.update(this.marked, 0.16 * radius, colors);
  }

  /** Marks that tell values; others are notes on the picture. */
  get tells(): boolean {
    return this.marked !== undefined && this.ownRange !== undefined;
  }

  eachEnd(visit: (x: number, y: number, z: number) => void): void {
    if (this.marked) eachJointEnd(this.marked, visit);
  }

  /** What the colours of joints show. */
  shownRange({ range, common, scheme }: Visibility): [number, number] | undefined {
    if (!this.ownRange) return undefined;
    if (range?.length === 2) return range as [number, number];
    const seen = widest([common, this.ownRange]);
    return seen && scheme.balanced ? balanced(seen) : seen;
  }
}
