// Strings between things: distance joints, springs and attachments, which have no shape of their own. The topology
// names their ends; this follows their rows.
import { Group, Vector3, Quaternion, type IUniform } from "three";
import { WideLines } from "./lines";
import type { DrawnString, StringEnd } from "../client/gen/truestep/v1/stream_pb";
import { scenery } from "./shading";
import type { SystemView } from "./system_view";

export class Strings {
  readonly object = new Group();
  private lines: WideLines | undefined;
  private strings: DrawnString[] = [];

  constructor(private readonly viewHeight: IUniform<number>) {}

  set(strings: DrawnString[]): void {
    this.strings = strings;
    this.lines?.dispose();
    this.lines = undefined;
    if (strings.length === 0) return;
    this.lines = new WideLines(this.viewHeight, { pixels: 2, radius: 0, opacity: 1, tube: true });
    this.lines.object.layers.enable(1);
    this.object.add(this.lines.object);
  }

  /** Follows the rows; strings of missing parts are not drawn. */
  update(view: (part: string) => SystemView | undefined): void {
    if (!this.lines) return;
    const ends: number[] = [];
    const turn = new Quaternion();
    const place = (end: StringEnd | undefined): Vector3 | undefined => {
      if (!end) return undefined;
      const { part, row, at } = end;
      const local = new Vector3().fromArray(at);
      if (part === "") return local;
      const found = view(part);
      if (!found || row >= found.count) return undefined;
      if (found.turns && at.some((c) => c !== 0)) {
        const q = found.turns;
        local.applyQuaternion(turn.set(q[4 * row + 1]!, q[4 * row + 2]!, q[4 * row + 3]!, q[4 * row]!));
      }
      return local.add(new Vector3().fromArray(found.positions, 3 * row));
    };
    for (const { a, b } of this.strings) {
      const [p, q] = [place(a), place(b)];
      if (p && q) ends.push(...p.toArray(), ...q.toArray());
    }
    this.lines.set(ends);
    this.lines.colorAll(scenery.ink);
  }

  /** Adds the ends that are fixed in the world. */
  reachOf(add: (x: number, y: number, z: number) => void): void {
    for (const { a, b } of this.strings) for (const end of [a, b]) if (end?.part === "") add(...(end.at as [number, number, number]));
  }
}
