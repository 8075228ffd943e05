// Contacts and joints over the bodies, seen through them: a contact is a dot and a line along its normal as long
// as its force, a joint is its ends and its axis in the colour of its kind.
import { BufferAttribute, BufferGeometry, Color, Group, LineBasicMaterial, LineSegments, Points, PointsMaterial } from "three";
import { floats } from "../client/decode";
import type { Marks } from "../client/gen/truestep/v1/stream_pb";

const contactColor = new Color("#ff5b4d");
/** Ball, hinge, slider, fixed, distance, other. */
const jointColors = ["#4fe3a1", "#5bb8ff", "#ffb14a", "#c792ff", "#dfe6ef", "#dfe6ef"].map((hex) => new Color(hex));

class Strokes {
  readonly object: LineSegments | Points;
  private readonly geometry = new BufferGeometry();
  private positions: number[] = [];
  private colors: number[] = [];

  constructor(kind: "lines" | "dots") {
    const common = { vertexColors: true, depthTest: false, depthWrite: false, transparent: true };
    this.object =
      kind === "lines" ? new LineSegments(this.geometry, new LineBasicMaterial(common)) : new Points(this.geometry, new PointsMaterial({ ...common, size: 5, sizeAttenuation: false }));
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
  end(): void {
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

  /** Draws `marks`, undefined for none; the longest line is `size` (m). */
  update(marks: Marks | undefined, size: number): void {
    this.lines.begin();
    this.dots.begin();
    let most = 0;
    for (const { contacts } of marks?.systems ?? []) {
      const c = floats(contacts);
      for (let k = 6; k < c.length; k += 7) most = Math.max(most, c[k]!);
    }
    for (const { contacts, joints, jointKinds } of marks?.systems ?? []) {
      const c = floats(contacts);
      for (let k = 0; k + 6 < c.length; k += 7) {
        const [x, y, z, nx, ny, nz, force] = c.subarray(k, k + 7) as unknown as [number, number, number, number, number, number, number];
        const length = (size * force) / most;
        this.dots.add(x, y, z, contactColor);
        this.lines.add(x, y, z, contactColor);
        this.lines.add(x + length * nx, y + length * ny, z + length * nz, contactColor);
      }
      const j = floats(joints);
      for (let k = 0; k + 8 < j.length; k += 9) {
        const [ax, ay, az, bx, by, bz, ux, uy, uz] = j.subarray(k, k + 9) as unknown as [number, number, number, number, number, number, number, number, number];
        const color = jointColors[Math.min(jointKinds[k / 9] ?? 5, 5)]!;
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
    this.lines.end();
    this.dots.end();
  }
}
