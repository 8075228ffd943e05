// A grid on the screen: a curve in one dimension; in the plane colours, or a surface raised by the value;
// in space a slice, or a few translucent ones.
import { BufferAttribute, BufferGeometry, Color, DoubleSide, DynamicDrawUsage, Group, Mesh, ShaderMaterial, type IUniform } from "three";
import type { FieldArray } from "../../client/decode";
import { shownField } from "../../client/parts";
import type { Lattice, Part } from "../../client/gen/truestep/v1/stream_pb";
import type { ViewerSettings } from "../../client/rest";
import { colorTable, inkOn, type ColorMap, type Theme } from "./color_map";
import { balanced, schemeOf, type Kind } from "./scheme";
import type { Extent } from "../extent";
import { WideLines } from "../lines";
import { arrows, levelLine } from "../plane_lines";
import { scaleLabel } from "./scale_label";
import { scenery, shadeGlsl } from "../shading";
import { GridVertices } from "./grid_vertices";
import { evenStreamlines } from "./streamlines";
import type { Has, Visibility } from "../system_view";
import { lightUniforms } from "../upright";

const kColors = 256;
const kSlices = 9;
const kCurveShare = 0.3; // a curve's height as a fraction of its length

/** The meaning of a grid's colours. */
export interface Scale {
  label: string;
  map: ColorMap;
  /** Instead of a bar, where colours are names. */
  kinds?: Kind[];
  low: number;
  high: number;
}

const vertex = /* glsl */ `
in vec3 tint;
in float share;
out vec3 vTint, vNormal, vWorld;
out float vShare;
void main() {
  vTint = tint;
  vShare = share;
  vNormal = normal;
  vWorld = position;
  gl_Position = projectionMatrix * (viewMatrix * vec4(position, 1.0));
}`;

const fragment = /* glsl */ `
uniform bool lit, translucent;
in vec3 vTint, vNormal, vWorld;
in float vShare;
${shadeGlsl}
void main() {
  vec3 toEye = normalize(cameraPosition - vWorld);
  vec3 n = normalize(vNormal);
  vec3 c = lit ? shade(vTint, dot(n, toEye) < 0.0 ? -n : n, toEye) : vTint;
  gl_FragColor = vec4(c, translucent ? mix(0.03, 0.5, vShare) : 1.0);
  #include <colorspace_fragment>
}`;

interface Sheet {
  mesh: Mesh;
  /** Along both sides, the axes of those, and what is drawn over it. */
  along: [GridVertices, GridVertices];
  axes: [number, number];
  over: WideLines | undefined;
  /** The grid's row of each vertex. */
  rows: Uint32Array;
  positions: Float32Array;
  tints: Float32Array;
  shares: Float32Array;
}

const linear = (byte: number): number => {
  const c = byte / 255;
  return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
};

export class GridView {
  readonly id: string;
  readonly group = new Group();
  readonly bodies = undefined;
  readonly pointRadius = 0;
  positions = new Float32Array(0);
  /** Rows that are shown. */
  count = 0;
  scale: Scale | undefined;
  private readonly sheets: Sheet[] = [];
  private curve: { lines: WideLines; base: WideLines; along: GridVertices; up: number; at: number; length: number; pairs: Uint32Array } | undefined;
  private field: FieldArray | undefined;
  /** Of the map, on the paper of `theme`. */
  private colors = new Float32Array(0);
  private theme: Theme | undefined;
  private readonly map: ColorMap;
  private values = new Float32Array(0);

  constructor(
    private readonly part: Part,
    private readonly settings: ViewerSettings,
    private readonly viewHeight: IUniform<number>,
  ) {
    this.id = part.id;
    const shown = shownField(part, settings.color_by ?? "");
    this.map = schemeOf({ ...settings, color_by: shown }, shown ?? "", part.fields.find((one) => one.name === shown)).map;
    const lattice = part.lattice!;
    const axes = [0, 1, 2].filter((axis) => lattice.counts[axis]! > 1);
    if (axes.length === 1) this.makeCurve(lattice, axes[0]!);
    else if (axes.length === 2) this.makeSheet(lattice, axes[0]!, axes[1]!, 0, false);
    else if (axes.length === 3) this.makeSlices(lattice);
  }

  /** The visible side of a flat grid; undefined for a grid drawn as a height surface or filling space. */
  get facing(): [number, number, number] | undefined {
    const { counts } = this.part.lattice!;
    const axes = [0, 1, 2].filter((axis) => counts[axis]! > 1);
    const unit = (axis: number): [number, number, number] => [axis === 0 ? 1 : 0, axis === 1 ? 1 : 0, axis === 2 ? 1 : 0];
    if (axes.length === 1) return axes[0] === 2 ? [1, 0, 0] : [0, 0, 1];
    if ((this.settings.height ?? 0) !== 0) return undefined;
    if (axes.length === 2) return unit(3 - axes[0]! - axes[1]!);
    return this.settings.slice ? unit("xyz".indexOf(this.settings.slice.axis ?? "z")) : undefined;
  }

  get range(): undefined {
    return undefined;
  }

  /** Adds the grid's present extent. */
  reachOf(out: Extent): void {
    out.addCloud(this.positions, this.positions.length / 3, 0, false);
    for (const { positions } of this.sheets) out.addCloud(positions, positions.length / 3, 0, false);
  }

  get has(): Has {
    return { points: false, lines: this.curve !== undefined || this.sheets.some((sheet) => sheet.over), surface: this.sheets.length > 0, bodies: false };
  }

  update(fields: FieldArray[], show: Visibility): void {
    const shown = shownField(this.part, show.colorBy);
    const field = fields.find((one) => one.field === shown);
    if (!field) return;
    this.field = field;
    this.tone();
    this.take(field);
    const [least, greatest] = this.settings.range?.length === 2 ? (this.settings.range as [number, number]) : this.map === "balance" ? balanced(extent(this.values)) : extent(this.values);
    const unit = this.part.fields.find((one) => one.name === field.field)?.unit ?? "";
    this.scale = { label: scaleLabel(this.settings, field.field, unit, field.width > 1), map: this.map, low: least, high: greatest };
    for (const sheet of this.sheets) {
      this.paint(sheet, least, greatest);
      if (!(sheet.mesh.material as ShaderMaterial).transparent) this.over(sheet, least, greatest);
    }
    if (this.curve) this.bend(least, greatest);
    this.apply(show);
  }

  apply(show: Visibility): void {
    if (this.field && this.theme !== scenery.theme) return this.update([this.field], show);
    for (const { mesh, over } of this.sheets) {
      mesh.visible = show.surface;
      if (over) over.object.visible = show.lines;
    }
    if (this.curve) this.curve.lines.object.visible = this.curve.base.object.visible = show.lines;
  }

  dispose(): void {
    for (const { mesh, over } of this.sheets) {
      over?.dispose();
      mesh.geometry.dispose();
      (mesh.material as ShaderMaterial).dispose();
    }
    this.curve?.lines.dispose();
    this.curve?.base.dispose();
    this.group.removeFromParent();
  }

  private tone(): void {
    if (this.theme === scenery.theme) return;
    this.theme = scenery.theme;
    this.colors = Float32Array.from(colorTable(this.map, kColors, this.theme), linear);
  }

  /** One number per row: the value, or the length of a vector. */
  private take({ count, width, data }: FieldArray): void {
    if (this.values.length !== count) this.values = new Float32Array(count);
    for (let r = 0; r < count; ++r) {
      let sum = 0;
      for (let c = 0; c < width; ++c) sum += data[r * width + c]! ** 2;
      this.values[r] = width === 1 ? data[r]! : Math.sqrt(sum);
    }
  }

  private paint(sheet: Sheet, low: number, high: number): void {
    const { rows, tints, shares, positions, mesh } = sheet;
    const height = this.settings.height ?? 0;
    const up = mesh.userData.up as number;
    const base = mesh.userData.base as Float32Array;
    for (let k = 0; k < rows.length; ++k) {
      const value = this.values[rows[k]!] ?? 0;
      const share = high > low ? Math.min(Math.max((value - low) / (high - low), 0), 1) : 0;
      const color = 3 * Math.round((Number.isFinite(share) ? share : 0) * (kColors - 1));
      shares[k] = share;
      for (let c = 0; c < 3; ++c) tints[3 * k + c] = this.colors[color + c]!;
      if (height !== 0) positions[3 * k + up] = base[k]! + height * value;
    }
    const { geometry } = mesh;
    geometry.getAttribute("tint").needsUpdate = true;
    geometry.getAttribute("share").needsUpdate = true;
    if (height === 0) return;
    geometry.getAttribute("position").needsUpdate = true;
    geometry.computeVertexNormals();
  }

  /** Contours, streamlines or arrows over a sheet, as the scene asks. */
  private over(sheet: Sheet, low: number, high: number): void {
    const { along: [first, second], axes, rows } = sheet;
    const { contours = 0, streamlines: lines = 0, height = 0 } = this.settings;
    const width = this.field!.width;
    if (contours <= 0 && width < 2) return sheet.over?.set([]);
    const ends: number[] = [];
    const lift = 1e-3 * Math.hypot(first.rows * this.spacing(axes[0]), second.rows * this.spacing(axes[1]));
    const place = (pieces: number[], up: number): void => {
      const { origin } = this.part.lattice!;
      const base = sheet.mesh.userData.base as Float32Array;
      const w = sheet.mesh.userData.up as number;
      for (let k = 0; k < pieces.length; k += 2) {
        const p = [0, 0, 0];
        p[w] = base[0]! + up;
        p[axes[0]] = origin[axes[0]]! + pieces[k]! * this.spacing(axes[0]);
        p[axes[1]] = origin[axes[1]]! + pieces[k + 1]! * this.spacing(axes[1]);
        ends.push(...p);
      }
    };
    if (contours > 0) {
      const flat = Float32Array.from(rows, (row) => this.values[row]!);
      for (let k = 1; k <= contours; ++k) {
        const level = low + ((high - low) * k) / (contours + 1);
        const pieces: number[] = [];
        levelLine(flat, { nx: first.count, ny: second.count }, level, pieces);
        for (let e = 0; e < pieces.length; e += 2) {
          pieces[e] = first.place(pieces[e]!);
          pieces[e + 1] = second.place(pieces[e + 1]!);
        }
        place(pieces, height * level + (height !== 0 ? lift : 0));
      }
    }
    if (width > 1) {
      const plane = { nx: first.rows, ny: second.rows, margin: first.margin };
      // Without the vertices at the edges.
      const inside = rows.filter((_, k) => [first, second].every((side, n) => {
        const at = n === 0 ? k % first.count : Math.floor(k / first.count);
        return side.margin === 0 || (at > 0 && at + 1 < side.count);
      }));
      const along = (axis: number, which: number): Float32Array => {
        const component = width === 2 ? which : axis;
        return Float32Array.from(inside, (row) => this.field!.data[row * width + component]!);
      };
      const [u, v] = [along(axes[0], 0), along(axes[1], 1)];
      const pieces: number[] = [];
      if (lines > 0) {
        const [du, dv] = axes.map((axis) => this.spacing(axis)) as [number, number];
        for (const line of evenStreamlines({ ...plane, u: u.map((x) => x / du), v: v.map((x) => x / dv) }, lines)) {
          for (let k = 0; k + 3 < line.length; k += 2) pieces.push(line[k]!, line[k + 1]!, line[k + 2]!, line[k + 3]!);
        }
      } else {
        arrows({ ...plane, u, v }, high, pieces);
      }
      place(pieces, 0);
    }
    if (!sheet.over) {
      sheet.over = new WideLines(this.viewHeight, { pixels: 1.5, radius: 0, opacity: 1, tube: false, above: height === 0 });
      this.group.add(sheet.over.object);
    }
    sheet.over.set(ends);
    sheet.over.colorAll(new Color(inkOn(this.map, scenery.theme)));
  }

  private spacing(axis: number): number {
    return this.part.lattice!.spacing[axis]!;
  }

  private bend(low: number, high: number): void {
    const { lines, base, along, up, at, length, pairs } = this.curve!;
    const x = this.positions;
    const value = (k: number): number => this.values[along.row(k)]!;
    const reach = Math.max(Math.abs(low), Math.abs(high));
    const height = this.settings.height ?? (reach > 0 ? (kCurveShare * length) / reach : 1);
    for (let k = 0; k < along.count; ++k) x[3 * k + up] = at + height * value(k);
    lines.connect(x, pairs);
    const share = (k: number): number => (high > low ? (value(k) - low) / (high - low) : 0);
    lines.values(Array.from({ length: pairs.length / 2 }, (_, k) => 0.5 * (share(k) + share(k + 1))));
    base.colorAll(scenery.ink);
  }

  private makeCurve(lattice: Lattice, axis: number): void {
    const along = new GridVertices(lattice, axis);
    const n = along.count;
    this.count = along.rows;
    this.positions = new Float32Array(3 * n);
    for (let k = 0; k < n; ++k) for (let c = 0; c < 3; ++c) this.positions[3 * k + c] = lattice.origin[c]! + (c === axis ? along.place(k) * lattice.spacing[c]! : 0);
    const up = axis === 1 ? 0 : 1;
    const length = (along.rows - 1 + 2 * along.margin) * lattice.spacing[axis]!;
    const lines = new WideLines(this.viewHeight, { pixels: 3, radius: 0.004 * length, opacity: 1, tube: true });
    lines.reserve(n - 1);
    const base = new WideLines(this.viewHeight, { pixels: 1.2, radius: 0, opacity: 0.7, tube: false });
    base.set([...this.positions.slice(0, 3), ...this.positions.slice(-3)]);
    const pairs = Uint32Array.from({ length: 2 * (n - 1) }, (_, k) => (k + 1) >> 1);
    this.curve = { lines, base, along, up, at: lattice.origin[up]!, length, pairs };
    this.group.add(base.object, lines.object);
  }

  private makeSlices(lattice: Lattice): void {
    const cut = this.settings.slice ? "xyz".indexOf(this.settings.slice.axis ?? "z") : 2;
    const [u, v] = [0, 1, 2].filter((axis) => axis !== cut) as [number, number];
    const last = lattice.counts[cut]! - 1;
    if (this.settings.slice) {
      const { at } = this.settings.slice;
      const layer = at === undefined ? Math.floor(last / 2) : Math.round((at - lattice.origin[cut]!) / lattice.spacing[cut]!);
      return this.makeSheet(lattice, u, v, Math.min(Math.max(layer, 0), last), false);
    }
    const slices = Math.min(kSlices, last + 1);
    for (let k = 0; k < slices; ++k) this.makeSheet(lattice, u, v, Math.floor((k * last) / (slices - 1)), true);
  }

  private makeSheet(lattice: Lattice, u: number, v: number, layer: number, translucent: boolean): void {
    const w = 3 - u - v;
    const step = [1, lattice.counts[0]!, lattice.counts[0]! * lattice.counts[1]!];
    const along: [GridVertices, GridVertices] = [new GridVertices(lattice, u), new GridVertices(lattice, v)];
    const [nu, nv] = [along[0].count, along[1].count];
    const rows = new Uint32Array(nu * nv);
    const positions = new Float32Array(3 * nu * nv);
    for (let j = 0, k = 0; j < nv; ++j) {
      for (let i = 0; i < nu; ++i, ++k) {
        rows[k] = along[0].row(i) * step[u]! + along[1].row(j) * step[v]! + layer * step[w]!;
        const place: number[] = [];
        place[u] = along[0].place(i);
        place[v] = along[1].place(j);
        place[w] = layer;
        for (let c = 0; c < 3; ++c) positions[3 * k + c] = lattice.origin[c]! + place[c]! * lattice.spacing[c]!;
      }
    }
    const triangles = new Uint32Array(6 * (nu - 1) * (nv - 1));
    for (let j = 0, k = 0; j + 1 < nv; ++j) {
      for (let i = 0; i + 1 < nu; ++i, k += 6) {
        const a = i + nu * j;
        triangles.set([a, a + 1, a + nu + 1, a, a + nu + 1, a + nu], k);
      }
    }
    const tints = new Float32Array(3 * nu * nv);
    const shares = new Float32Array(nu * nv);
    const geometry = new BufferGeometry();
    const dynamic = (data: Float32Array, width: number): BufferAttribute => new BufferAttribute(data, width).setUsage(DynamicDrawUsage);
    geometry.setAttribute("position", dynamic(positions, 3));
    geometry.setAttribute("tint", dynamic(tints, 3));
    geometry.setAttribute("share", dynamic(shares, 1));
    geometry.setAttribute("normal", new BufferAttribute(new Float32Array(3 * nu * nv).fill(1), 3));
    geometry.setIndex(new BufferAttribute(triangles, 1));
    const lit = (this.settings.height ?? 0) !== 0;
    const material = new ShaderMaterial({
      uniforms: { ...lightUniforms, lit: { value: lit }, translucent: { value: translucent } }, vertexShader: vertex, fragmentShader: fragment, side: DoubleSide,
      transparent: translucent, depthWrite: !translucent,
    });
    const mesh = new Mesh(geometry, material);
    mesh.frustumCulled = false;
    mesh.renderOrder = translucent ? layer : 0;
    Object.assign(mesh.userData, { up: w, base: Float32Array.from(rows, (_, k) => positions[3 * k + w]!) });
    this.group.add(mesh);
    this.count += along[0].rows * along[1].rows;
    this.sheets.push({ mesh, along, axes: [u, v], over: undefined, rows, positions, tints, shares });
    const all = new Float32Array(this.positions.length + positions.length);
    all.set(this.positions);
    all.set(positions, this.positions.length);
    this.positions = all;
  }
}

function extent(values: Float32Array): [number, number] {
  let low = Infinity;
  let high = -Infinity;
  for (const v of values) {
    if (v < low) low = v;
    if (v > high) high = v;
  }
  return low <= high ? [low, high] : [0, 1];
}
