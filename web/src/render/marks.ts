// Contacts and joints over the bodies, seen through them: a contact is a dot and a line along its normal as long
// as its force, a joint is its ends and its axis in the colour of its kind.
import { BufferAttribute, BufferGeometry, Color, Group, LineBasicMaterial, LineSegments, Points, PointsMaterial } from "three";
import { floats } from "../client/decode";
import type { Marks } from "../client/gen/truestep/v1/stream_pb";

const contactColor = new Color("#ff5b4d");
/** Spherical, revolute, prismatic, fixed, distance, other. */
const jointColors = ["#4fe3a1", "#5bb8ff", "#ffb14a", "#c792ff", "#dfe6ef", "#dfe6ef"].map((hex) => new Color(hex));

/** Visits the two ends of every joint. */
export function eachJointEnd(marks: Pick<Marks, "joints">, visit: (x: number, y: number, z: number) => void): void {
  const j = floats(marks.joints);
  for (let k = 0; k + 8 < j.length; k += 9) for (const e of [k, k + 3]) visit(j[e]!, j[e + 1]!, j[e + 2]!);
}

/** Pixels; larger where colours tell values. */
const kDot = 5, kValuedDot = 12;

class Strokes {
  readonly object: LineSegments | Points;
  private readonly geometry = new BufferGeometry();
  private positions: number[] = [];
  private colors: number[] = [];

  constructor(kind: "lines" | "dots") {
    const common = { vertexColors: true, depthTest: false, depthWrite: false, transparent: true };
    this.object =
      kind === "lines" ? new LineSegments(this.geometry, new LineBasicMaterial(common)) : new Points(this.geometry, new PointsMaterial({ ...common, size: kDot, sizeAttenuation: false }));
    this.object.frustumCulled = false;
    this.object.renderOrder = 5;
  }
  begin(): void {
    this.positions = [];
    this.colors = [];
  }
  add(x: number, y: number, z: number, color: Color): void {
    this.positions.push(x, y, z);
    this.colors.push(color.r, color.g, color.b);
  }
  end(size = kDot): void {
    if (this.object instanceof Points) (this.object.material as PointsMaterial).size = size;
    this.geometry.dispose(); // a buffer of another length
    this.geometry.setAttribute("position", new BufferAttribute(Float32Array.from(this.positions), 3));
    this.geometry.setAttribute("color", new BufferAttribute(Float32Array.from(this.colors), 3));
    this.object.visible = this.positions.length > 0;
  }
}

export class MarkLines {
  readonly object = new Group();
  private readonly lines = new Strokes("lines");
  private readonly dots = new Strokes("dots");

  constructor() {
    this.object.add(this.lines.object, this.dots.object);
    this.update(undefined, 1);
  }

  /** Draws `marks` (undefined: none); the longest line is `size` (m). Joints have these colours, or those of their kinds. */
  update(marks: Marks | undefined, size: number, colors: readonly (Color | undefined)[] = []): void {
    this.lines.begin();
    this.dots.begin();
    if (marks) this.draw(marks, size, colors);
    this.lines.end();
    this.dots.end(colors.some((color) => color) ? kValuedDot : kDot);
  }

  private draw({ contacts, joints, jointKinds }: Marks, size: number, colors: readonly (Color | undefined)[]): void {
    let most = 0;
    const c = floats(contacts);
    for (let k = 6; k < c.length; k += 7) most = Math.max(most, c[k]!);
    for (let k = 0; k + 6 < c.length; k += 7) {
      const x = c[k]!, y = c[k + 1]!, z = c[k + 2]!;
      const length = (size * c[k + 6]!) / most;
      this.dots.add(x, y, z, contactColor);
      this.lines.add(x, y, z, contactColor);
      this.lines.add(x + length * c[k + 3]!, y + length * c[k + 4]!, z + length * c[k + 5]!, contactColor);
    }
    const j = floats(joints);
    for (let k = 0; k + 8 < j.length; k += 9) {
      const ax = j[k]!, ay = j[k + 1]!, az = j[k + 2]!, bx = j[k + 3]!, by = j[k + 4]!, bz = j[k + 5]!;
      const ux = j[k + 6]!, uy = j[k + 7]!, uz = j[k + 8]!;
      const color = colors[k / 9] ?? jointColors[Math.min(jointKinds[k / 9] ?? 5, 5)]!;
      this.dots.add(ax, ay, az, color);
      this.dots.add(bx, by, bz, color);
      this.lines.add(ax, ay, az, color);
      this.lines.add(bx, by, bz, color);
      if (ux === 0 && uy === 0 && uz === 0) continue;
      const arm = 0.35 * size;
      this.lines.add(ax - arm * ux, ay - arm * uy, az - arm * uz, color);
      this.lines.add(ax + arm * ux, ay + arm * uy, az + arm * uz, color);
    }
  }
}
