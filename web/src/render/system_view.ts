// One system on the screen: its positions in one array that points, lines and triangles share.
import { BufferAttribute, Color, DynamicDrawUsage, Group, SRGBColorSpace, Vector3, type IUniform } from "three";
import { uints, type FieldArray } from "../client/decode";
import { Bodies, type FloorUniforms } from "./bodies";
import { meaning } from "../client/parts";
import type { Extent } from "./extent";
import type { Part, SystemTopology } from "../client/gen/truestep/v1/stream_pb";
import type { Label } from "./labels";
import { Liquid } from "./fields/liquid";
import { kindColors, WideLines } from "./lines";
import { PointCloud } from "./points";
import { paletteColor } from "./shading";
import { triangleValues } from "./fields/element_values";
import { balanced, kindAt, kRampStops, type Scheme } from "./fields/scheme";
import { Surface } from "./fields/surface";
import { ValueRange, widest } from "./value_range";
import { extremes, mine, sizes, values, type Names } from "./values";

const kMarked = 128; // points
const kNet = 1500; // lines

export interface Visibility {
  points: boolean;
  lines: boolean;
  surface: boolean;
  /** Colour points by their speed, or by the field named in the scene, if the server sends it. */
  bySpeed: boolean;
  /** Name of that field; "" for speed. */
  colorBy: string;
  /** Lowest and highest value of the colours, if given by the scene. */
  range?: number[];
  /** What the colours mean. */
  scheme: Scheme;
  /** Without a range: the lowest and highest value on the screen, so that one colour bar explains all systems. */
  common?: [number, number];
}

/** Which switches have an effect. */
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
  /** Orientations of the rows (w x y z), if any. */
  turns: ArrayLike<number> | undefined;
  private attribute = new BufferAttribute(this.positions, 3);
  private points: PointCloud | undefined;
  private surface: Surface | undefined;
  private liquid: Liquid | undefined;
  private lines: WideLines | undefined;
  private lineScale: [number, number] | undefined;
  /** What colours the points, and whether the liquid's surface is that of the last frame. */
  private shades: Float32Array | undefined;
  /** Where points have no values: what colours the triangles. */
  private facets: Float32Array | undefined;
  private surfaceRange: [number, number] | undefined;
  private wrapped = false;
  private readonly pairs: Uint32Array;
  /** Which of the lines are drawn, and their rows. */
  private kept: number[] = [];
  private drawn = new Uint32Array(0);
  /** Bodies, if there are any, are at their rows. */
  placed = true;
  private bodyRange: [number, number] | undefined;
  /** Kinds that its values have now. */
  readonly present = new Set<number>();
  private scratch = new Float32Array(0);
  /** Of its own values. */
  private readonly own = new ValueRange();
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
    private readonly trails = false,
    smooth = false,
    /** What the values of another part of the system belong to: "lines", "triangles". */
    private readonly elementsOf: (id: string) => string | undefined = () => undefined,
  ) {
    this.names = { position: meaning(part, "position"), orientation: meaning(part, "orientation"), asleep: meaning(part, "asleep"), velocity: meaning(part, "velocity") };

    const [r, g, b] = topology.color;
    this.color = r !== undefined && g !== undefined && b !== undefined ? new Color().setRGB(r, g, b, SRGBColorSpace) : undefined;
    this.pairs = uints(topology.lines);
    this.triangles = uints(topology.triangles);
    if (topology.visuals.length > 0) {
      this.bodies = new Bodies(topology, floor, index);
      this.placed = this.bodies.rows === 0;
      this.group.add(this.bodies.group);
    }
    if (topology.pointRadius > 0) this.points = new PointCloud(topology.pointRadius, this.fill(), viewHeight);
    if (smooth && this.points && !this.bodies && !topology.plane && this.pairs.length === 0 && this.triangles.length === 0) {
      this.liquid = new Liquid(2 * topology.pointRadius, this.fill());
      this.liquid.object.layers.enable(1);
      this.group.add(this.liquid.object);
    }
  }

  /** The colour that the scene gives to part of it. */
  get givenColor(): Color | undefined {
    if (this.color) return this.color;
    const [r, g, b] = this.topology.visuals.find((visual) => visual.color.length === 3)?.color ?? [];
    return r !== undefined && g !== undefined && b !== undefined ? new Color().setRGB(r, g, b, SRGBColorSpace) : undefined;
  }

  get pointRadius(): number {
    return this.topology.pointRadius;
  }

  /** What a viewer can switch: points, lines, surface. */
  get has(): Has {
    const bodies = this.bodies !== undefined;
    const surface = this.triangles.length > 0 || bodies || this.liquid !== undefined;
    return { points: this.points !== undefined || (!surface && this.count <= kMarked), lines: this.pairs.length > 0, surface, bodies };
  }

  /** Takes a frame's fields of this system. */
  update(fields: FieldArray[], show: Visibility): void {
    const position = fields.find((field) => field.system === this.id && field.field === this.names.position);
    if (position) this.take(position);
    this.mark();
    this.shades = show.bySpeed ? values(mine(fields, this.id), show.colorBy || "speed", this.names, this.room) : undefined;
    this.facets = this.shades ? undefined : this.facetValues(fields, show);
    this.present.clear();
    if (show.scheme.kinds.length > 0) {
      this.shades = this.shades && this.kindsOf(this.shades, show.scheme);
      this.facets = this.facets && this.kindsOf(this.facets, show.scheme);
    }
    const colored = this.shades ?? this.facets;
    if (colored) this.own.take(colored, colored.length);
    else this.own.forget();
    this.carry(fields, show);
    this.colorLines(fields, show);
    this.points?.update(this.positions, this.count, this.shades, this.rangeOf(show));
    if (this.points?.object && !this.points.object.parent) {
      this.points.object.layers.enable(1);
      this.group.add(this.points.object);
    }
    this.surfaceRange = this.surface && colored ? this.rangeOf(show) : undefined;
    this.surface?.color(this.shades, this.facets, this.rangeOf(show));
    if (this.surface?.object.visible) this.surface.update();
    this.wrapped = false;
    this.apply(show);
  }

  /** Hides and shows the parts. */
  apply(show: Visibility): void {
    if (this.bodies) this.bodies.group.visible = show.surface;
    if (this.points?.object) this.points.object.visible = show.points && !(this.liquid && show.surface);
    if (this.liquid) {
      this.liquid.object.visible = show.surface;
      if (show.surface && !this.wrapped) this.liquid.update(this.positions, this.count, this.shades, this.points?.range);
      this.wrapped = this.wrapped || show.surface;
    }
    if (this.lines) this.lines.object.visible = show.lines;
    if (this.surface && this.surface.object.visible !== show.surface) {
      this.surface.object.visible = show.surface;
      if (show.surface) this.surface.update();
    }
  }

  dispose(): void {
    this.points?.dispose();
    this.bodies?.dispose();
    this.surface?.dispose();
    this.liquid?.dispose();
    this.lines?.dispose();
    this.group.removeFromParent();
  }

  /** Adds the present extent, ignoring outliers of a cloud of particles. */
  reachOf(out: Extent): void {
    if (this.bodies) this.bodies.reachOf(out);
    if (this.bodies && !this.points && this.pairs.length === 0) return;
    const loose = this.pairs.length === 0 && this.triangles.length === 0;
    out.addCloud(this.positions, this.count, this.points ? this.pointRadius : 0, loose);
  }

  /** Centre of everything that moves. */
  middle(): Vector3 | undefined {
    if (this.bodies) return this.bodies.middle();
    if (this.count === 0) return undefined;
    const sum = new Vector3();
    for (let k = 0; k < this.count; ++k) sum.add(new Vector3().fromArray(this.positions, 3 * k));
    return sum.divideScalar(this.count);
  }

  /** The colour that stands for the system. */
  get tint(): Color {
    return this.fill();
  }

  /** Moves the bodies with their rows. */
  private carry(fields: FieldArray[], show: Visibility): void {
    const turn = fields.find((field) => field.system === this.id && field.field === this.names.orientation);
    this.turns = turn?.data;
    if (!this.bodies || !turn || this.count < this.bodies.rows || turn.count < this.bodies.rows) return;
    this.placed = true;
    const asleep = fields.find((field) => field.system === this.id && field.field === this.names.asleep)?.data;
    const { shades } = this;
    const [low, high] = this.rangeOf(show);
    this.bodyRange = shades ? [low, high] : undefined;
    const scale = high > low ? 1 / (high - low) : 0;
    this.bodies.update(this.positions, turn.data, shades?.map((v) => v - low) ?? asleep, shades ? scale : 1, shades !== undefined);
  }

  private fill(): Color {
    return this.color ?? paletteColor(this.index);
  }

  /** Marks the points of a small network without a size; otherwise two masses on springs would be two thin lines. */
  private mark(): void {
    if (this.points || this.bodies || this.triangles.length > 0 || this.count === 0 || this.count > kMarked) return;
    let longest = 0;
    for (let k = 0; k < 3 * this.count; ++k) longest = Math.max(longest, Math.abs(this.positions[k]! - this.positions[k % 3]!));
    this.points = new PointCloud(Math.min(0.08, 0.35 / (this.count - 1 || 1)) * longest || 1e-3, this.fill(), this.viewHeight);
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
    this.lines?.connect(this.positions, this.drawn);
  }

  /** Tubes for ropes, hair and trails; over a surface the structural springs as a faint net. */
  private string(): void {
    const kinds = this.topology.lineKind;
    const faint = this.surface !== undefined;
    const kept: number[] = [];
    for (let k = 0; 2 * k < this.pairs.length; ++k) if (!faint || (kinds[k] ?? 0) === 0) kept.push(k);
    this.kept = kept;
    this.drawn = Uint32Array.from(kept.flatMap((k) => [this.pairs[2 * k]!, this.pairs[2 * k + 1]!]));
    // Many lines at many points are a net or hair: as wide as ropes they would merge.
    const many = kept.length > kNet && !this.trails;
    this.lines = new WideLines(this.viewHeight, { pixels: faint ? 1 : many ? 1.6 : 3, radius: faint || many ? 0 : this.topology.pointRadius / 4, opacity: faint ? 0.16 : 1, tube: !faint });
    this.lines.reserve(kept.length);
    const colors = kindColors(this.fill());
    const threads = faint ? undefined : this.threads(kept);
    kept.forEach((k, at) => this.lines!.color(at, threads ? threads[at]! : colors[Math.min(kinds[k] ?? 0, 3)]!));
    if (!faint) this.lines.object.layers.enable(1);
    this.group.add(this.lines.object);
  }

  /** Trails of equations: unconnected pieces are separate curves with separate colours. */
  private threads(kept: number[]): Color[] | undefined {
    if (!this.trails || this.color) return undefined;
    let thread = this.index - 1;
    return kept.map((k) => {
      if (k === 0 || this.pairs[2 * k] !== this.pairs[2 * k - 1]) ++thread;
      return paletteColor(thread);
    });
  }

  /** Names of a plot's curves, if each has one, at their newest points. */
  curves(): Label[] {
    const names = this.topology.curves;
    if (names.length === 0) return [];
    const starts: number[] = [];
    for (let k = 0; 2 * k < this.pairs.length; ++k) if (k === 0 || this.pairs[2 * k] !== this.pairs[2 * k - 1]) starts.push(3 * this.pairs[2 * k]!);
    return names.slice(0, starts.length).map((text, n) => {
      const [x = 0, y = 0, z = 0] = this.positions.subarray(starts[n]!, starts[n]! + 3);
      return { text, at: [x, y, z], kind: "name", color: `#${(this.color ?? paletteColor(this.index + n)).getHexString()}` };
    });
  }

  /** The field named in the scene, of a part with a value for each of these. */
  private elementField(elements: string, fields: FieldArray[], show: Visibility): FieldArray | undefined {
    if (!show.bySpeed || !show.colorBy) return undefined;
    return fields.find((one) => one.field === show.colorBy && this.elementsOf(one.system) === elements);
  }

  /** The number of each value's kind. */
  private kindsOf(values: Float32Array, scheme: Scheme): Float32Array {
    const kinds = values.map((value) => kindAt(scheme, value));
    for (const kind of kinds) this.present.add(kind);
    return kinds;
  }

  private facetValues(fields: FieldArray[], show: Visibility): Float32Array | undefined {
    const field = this.triangles.length > 0 ? this.elementField("triangles", fields, show) : undefined;
    return field && triangleValues(this.topology, field);
  }

  /** Colours lines by the field named in the scene, if a part has a value for each line. */
  private colorLines(fields: FieldArray[], show: Visibility): void {
    if (!this.lines) return;
    const field = this.elementField("lines", fields, show);
    this.lineScale = undefined;
    if (field?.count !== this.pairs.length / 2) return this.lines.values(undefined);
    const { scheme } = show;
    const named = scheme.kinds.length > 0;
    const size = named ? this.kindsOf(sizes(field), scheme) : sizes(field);
    const [low, high] = named || show.range?.length === 2 ? this.rangeOf(show) : scheme.balanced ? balanced(extremes(size)) : extremes(size);
    this.lineScale = [low, high];
    this.lines.values(this.kept.map((k) => (high > low ? (size[k]! - low) / (high - low) : 0)));
  }

  /** Range of values shown by the colours; undefined if nothing is coloured. */
  get range(): [number, number] | undefined {
    return this.lineScale ?? this.points?.range ?? this.bodyRange ?? this.surfaceRange;
  }

  /** Lowest and highest of its own values that colours show. */
  get ownRange(): [number, number] | undefined {
    return this.own.ends;
  }

  /** The next frame is not the successor of the last one. */
  forgetRange(): void {
    this.own.forget();
  }

  /** Where values are computed, frame after frame. */
  private readonly room = (count: number): Float32Array => {
    if (this.scratch.length < count) this.scratch = new Float32Array(count);
    return this.scratch.subarray(0, count);
  };

  private rangeOf({ range, common, scheme }: Visibility): [number, number] {
    if (scheme.kinds.length > 0) return [0, kRampStops - 1];
    if (range?.length === 2) return range as [number, number];
    const seen = widest([common, this.own.ends]) ?? [0, 1];
    return scheme.balanced ? balanced(seen) : seen;
  }

  /** New arrays, with lines and triangles over them; a topology with invalid rows is not drawn. */
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
    this.lines?.dispose();
    this.lines = undefined;
    if (inside(this.pairs)) this.string();
  }
}
