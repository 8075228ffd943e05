// One system on the screen: its positions in one array that points, lines and triangles share.
import { BufferAttribute, Color, DynamicDrawUsage, Group, type IUniform, type LineSegments } from "three";
import { uints, type FieldArray } from "../client/decode";
import { Bodies, type FloorUniforms } from "./bodies";
import { meaning } from "../client/parts";
import type { Part, SystemTopology } from "../client/gen/truestep/v1/stream_pb";
import { makeLines } from "./lines";
import { PointCloud } from "./points";
import { palette } from "./shading";
import { Surface } from "./surface";

const kMarked = 128; // points

export interface Visibility {
  points: boolean;
  lines: boolean;
  surface: boolean;
  /** Colour points by their speed, or by the field that the scene names, where the server sends it. */
  bySpeed: boolean;
  /** Name of that field; "" for speed, and only where a system has no colour of its own. */
  colorBy: string;
}

/** Which switches do something. */
export interface Has {
  points: boolean;
  lines: boolean;
  surface: boolean;
  bodies: boolean;
}

export class SystemView {
  readonly group = new Group();
  readonly bodies: Bodies | undefined;
  positions = new Float32Array(0);
  count = 0;
  private attribute = new BufferAttribute(this.positions, 3);
  private points: PointCloud | undefined;
  private surface: Surface | undefined;
  private lines: LineSegments | undefined;
  private readonly pairs: Uint32Array;
  private readonly triangles: Uint32Array;
  private readonly color: Color | undefined;
  private readonly names: Names;

  constructor(
    readonly id: string,
    private readonly topology: SystemTopology,
    private readonly index: number,
    private readonly viewHeight: IUniform<number>,
    floor: FloorUniforms,
    part: Part | undefined,
  ) {
    this.names = { position: meaning(part, "position"), orientation: meaning(part, "orientation"), asleep: meaning(part, "asleep"), velocity: meaning(part, "velocity") };

    const [r, g, b] = topology.color;
    this.color = r !== undefined && g !== undefined && b !== undefined ? new Color().setRGB(r, g, b) : undefined;
    this.pairs = uints(topology.lines);
    this.triangles = uints(topology.triangles);
    if (topology.visuals.length > 0) {
      this.bodies = new Bodies(topology, floor);
      this.group.add(this.bodies.group);
    }
    if (topology.pointRadius > 0) this.points = new PointCloud(topology.pointRadius, this.fill(), viewHeight);
  }

  get pointRadius(): number {
    return this.topology.pointRadius;
  }

  /** What a viewer can switch: points, lines, surface. */
  get has(): Has {
    const bodies = this.bodies !== undefined;
    const surface = this.triangles.length > 0 || bodies;
    return { points: this.points !== undefined || (!surface && this.count <= kMarked), lines: this.pairs.length > 0, surface, bodies };
  }

  /** Takes a frame's fields of this system. */
  update(fields: FieldArray[], show: Visibility): void {
    const position = fields.find((field) => field.field === this.names.position);
    if (position) this.take(position);
    this.mark();
    this.carry(fields, show);
    this.points?.update(this.positions, this.count, show.bySpeed && (show.colorBy || !this.color) ? values(fields, show.colorBy, this.names) : undefined);
    if (this.points?.object && !this.points.object.parent) {
      this.points.object.layers.enable(1);
      this.group.add(this.points.object);
    }
    if (this.surface?.object.visible) this.surface.update();
    this.apply(show);
  }

  /** Hides and shows the parts. */
  apply(show: Visibility): void {
    if (this.bodies) this.bodies.group.visible = show.surface;
    if (this.points?.object) this.points.object.visible = show.points;
    if (this.lines) this.lines.visible = show.lines;
    if (this.surface && this.surface.object.visible !== show.surface) {
      this.surface.object.visible = show.surface;
      if (show.surface) this.surface.update();
    }
  }

  dispose(): void {
    this.points?.dispose();
    this.bodies?.dispose();
    this.surface?.dispose();
    this.lines?.geometry.dispose();
    this.group.removeFromParent();
  }

  /** Moves the bodies with their rows. */
  private carry(fields: FieldArray[], show: Visibility): void {
    const turn = fields.find((field) => field.field === this.names.orientation);
    if (!this.bodies || !turn || this.count < this.bodies.rows || turn.count < this.bodies.rows) return;
    const speed = show.bySpeed && show.colorBy ? values(fields, show.colorBy, this.names) : undefined;
    const asleep = fields.find((field) => field.field === this.names.asleep)?.data;
    const top = speed?.reduce((most, v) => Math.max(most, v), 1e-6) ?? 1;
    this.bodies.update(this.positions, turn.data, speed ?? asleep, 1 / top, speed !== undefined);
  }

  private fill(): Color {
    return this.color ?? palette[this.index % palette.length]!;
  }

  /** Marks the points of a small network that has no size of its own, or two masses on springs are two thin lines. */
  private mark(): void {
    if (this.points || this.bodies || this.triangles.length > 0 || this.count === 0 || this.count > kMarked) return;
    let longest = 0;
    for (let k = 0; k < 3 * this.count; ++k) longest = Math.max(longest, Math.abs(this.positions[k]! - this.positions[k % 3]!));
    this.points = new PointCloud(Math.max(Math.min(0.08, 0.35 / (this.count - 1 || 1)) * longest, 1e-3), this.fill(), this.viewHeight);
  }

  private take(field: FieldArray): void {
    const { count, width, data } = field;
    if (3 * count > this.positions.length || this.attribute.array !== this.positions) this.grow(count);
    this.count = count;
    if (width === 3) {
      this.positions.set(data);
    } else {
      this.positions.fill(0);
      for (let k = 0; k < count; ++k) for (let c = 0; c < Math.min(width, 3); ++c) this.positions[3 * k + c] = data[k * width + c]!;
    }
    this.attribute.needsUpdate = true;
  }

  /** New arrays, and lines and triangles over them; a topology that names rows beyond them is not drawn. */
  private grow(count: number): void {
    this.positions = new Float32Array(3 * count);
    this.attribute = new BufferAttribute(this.positions, 3).setUsage(DynamicDrawUsage);
    const inside = (index: Uint32Array): boolean => index.length > 0 && index.reduce((a, b) => Math.max(a, b), 0) < count;
    this.surface?.dispose();
    this.surface = undefined;
    if (inside(this.triangles)) {
      this.surface = new Surface(this.attribute, this.triangles, this.fill());
      this.surface.object.layers.enable(1);
      this.group.add(this.surface.object);
    }
    this.lines?.geometry.dispose();
    this.lines?.removeFromParent();
    this.lines = undefined;
    if (inside(this.pairs)) {
      this.lines = makeLines(this.attribute, this.pairs, this.topology.lineKind, this.color, this.surface !== undefined);
      if (!this.surface) this.lines.layers.enable(1);
      this.group.add(this.lines);
    }
  }
}

/** Fields by what they mean. */
interface Names {
  position: string | undefined;
  orientation: string | undefined;
  asleep: string | undefined;
  velocity: string | undefined;
}

let scratch = new Float32Array(0);

/** A value per point: the named field, else speed, else the length of velocity; undefined without any. */
function values(fields: FieldArray[], name: string, names: Names): Float32Array | undefined {
  for (const wanted of [name, "speed"]) {
    const scalar = fields.find((field) => field.field === wanted && field.width === 1);
    if (scalar) return scalar.data instanceof Float32Array ? scalar.data : Float32Array.from(scalar.data);
  }
  const velocity = fields.find((field) => field.field === names.velocity && field.width === 3);
  if (!velocity) return undefined;
  const { count, data } = velocity;
  if (scratch.length < count) scratch = new Float32Array(count);
  for (let k = 0; k < count; ++k) {
    const x = data[3 * k]!, y = data[3 * k + 1]!, z = data[3 * k + 2]!;
    scratch[k] = Math.sqrt(x * x + y * y + z * z);
  }
  return scratch.subarray(0, count);
}
