// Solids that rows of a system carry: one instanced drawable for all boxes, one for all spheres, capsules and
// cylinders each, one per mesh. What never changes (size, colour) is uploaded once; a frame brings positions,
// orientations and sleep states. Fixed bodies are drawn separately: wide ones can be floors with shadows on them.
import {
  Box3, BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, Color, CylinderGeometry, DynamicDrawUsage, Group,
  InstancedBufferAttribute, InstancedBufferGeometry, Mesh, ShaderMaterial, SphereGeometry, SRGBColorSpace, Vector3, type IUniform,
} from "three";
import { floats, uints } from "../client/decode";
import { Motion, type Visual, type SystemTopology } from "../client/gen/truestep/v1/stream_pb";
import type { Extent } from "./extent";
import { bodyFragment, bodyVertex, paletteColor, rampUniform } from "./shading";
import { geometryOfMesh } from "./shapes";
import { lightUniforms, upward } from "./upright";

const kMany = 400; // instances of a round shape, drawn with fewer triangles beyond
const kWide = 2.5; // a fixed body this many times wider than everything that moves is a floor

const motionColor = new Map([
  [Motion.FIXED, new Color("#8a919c")],
  [Motion.KINEMATIC, new Color("#6d86ad")],
  [Motion.SENSOR, new Color("#58b4d8")],
]);

/** A visual as numbers: its pose relative to its row, and the box around it in its own frame. */
interface Part {
  visual: Visual;
  palette: number; // its colour without one of its own
  kind: string;
  at: [number, number, number];
  turn: [number, number, number, number]; // x y z w
  size: [number, number, number];
  low: Vector3;
  high: Vector3;
  radius: number; // about the row
}

interface Batch {
  mesh: Mesh<InstancedBufferGeometry, ShaderMaterial>;
  rows: Uint32Array;
  parts: Part[];
  fixed: boolean;
  plain: boolean; // every part sits on its row as it is
  center: InstancedBufferAttribute;
  turn: InstancedBufferAttribute;
  value: InstancedBufferAttribute;
}

export interface FloorUniforms {
  coverage: IUniform;
  toLight: IUniform;
  shadow: IUniform;
}

export class Bodies {
  readonly group = new Group();
  /** Radius around each row, m; -1 for rows that cannot be moved. */
  readonly reach: Float32Array;
  readonly rows: number;
  private readonly batches: Batch[] = [];

  /** Bodies without a colour have those of the palette from the `first` on. */
  constructor(topology: SystemTopology, floor: FloorUniforms, first = 0) {
    const parts = topology.visuals.map((visual) => partOf(visual, topology, first));
    const instances = uints(topology.instances);
    const groups = new Map<string, number[]>();
    let rows = 0;
    for (let k = 0; k + 1 < instances.length; k += 2) {
      const part = parts[instances[k + 1]!];
      if (!part) continue;
      rows = Math.max(rows, instances[k]! + 1);
      const { motion } = part.visual;
      const key = `${part.kind} ${motion === Motion.FIXED ? "fixed" : motion === Motion.SENSOR ? "sensor" : ""}`;
      (groups.get(key) ?? groups.set(key, []).get(key)!).push(k);
    }
    this.rows = rows;
    this.reach = new Float32Array(rows).fill(-1);
    for (const [key, members] of groups) {
      const mine = members.map((k) => parts[instances[k + 1]!]!);
      const batch = makeBatch(key, Uint32Array.from(members, (k) => instances[k]!), mine, topology, floor);
      this.batches.push(batch);
      this.group.add(batch.mesh);
      if (batch.fixed) continue;
      batch.rows.forEach((row, k) => (this.reach[row] = Math.max(this.reach[row]!, mine[k]!.radius)));
    }
  }

  /** Moves every body to its row. `values` colour them (0 to 1) if `byValue`, otherwise they mark sleeping bodies. */
  update(position: Float32Array, orientation: ArrayLike<number>, values: ArrayLike<number> | undefined, scale: number, byValue: boolean): void {
    for (const batch of this.batches) {
      const { rows, parts } = batch;
      const center = batch.center.array as Float32Array;
      const turn = batch.turn.array as Float32Array;
      const value = batch.value.array as Float32Array;
      for (let k = 0; k < rows.length; ++k) {
        const row = rows[k]!;
        const qw = orientation[4 * row]!, qx = orientation[4 * row + 1]!, qy = orientation[4 * row + 2]!, qz = orientation[4 * row + 3]!;
        let cx = position[3 * row]!, cy = position[3 * row + 1]!, cz = position[3 * row + 2]!;
        let x = qx, y = qy, z = qz, w = qw;
        if (!batch.plain) {
          const [px, py, pz] = parts[k]!.at;
          const [tx, ty, tz, tw] = parts[k]!.turn;
          const ux = qy * pz - qz * py + qw * px, uy = qz * px - qx * pz + qw * py, uz = qx * py - qy * px + qw * pz;
          cx += px + 2 * (qy * uz - qz * uy);
          cy += py + 2 * (qz * ux - qx * uz);
          cz += pz + 2 * (qx * uy - qy * ux);
          x = qw * tx + qx * tw + qy * tz - qz * ty;
          y = qw * ty + qy * tw + qz * tx - qx * tz;
          z = qw * tz + qz * tw + qx * ty - qy * tx;
          w = qw * tw - qx * tx - qy * ty - qz * tz;
        }
        center[3 * k] = cx; center[3 * k + 1] = cy; center[3 * k + 2] = cz;
        turn[4 * k] = x; turn[4 * k + 1] = y; turn[4 * k + 2] = z; turn[4 * k + 3] = w;
        value[k] = values ? values[row]! * scale : 0;
      }
      batch.center.needsUpdate = batch.turn.needsUpdate = batch.value.needsUpdate = true;
      batch.mesh.material.uniforms.byValue!.value = byValue && !batch.fixed;
    }
  }

  /** Adds the corners of everything that moves. */
  reachOf(out: Extent): void {
    const one = new Box3();
    for (const batch of this.batches) {
      if (batch.fixed) continue;
      for (let k = 0; k < batch.rows.length; ++k) addBox(out, boundsOf(batch, k, one));
    }
  }

  /** Centre of everything that moves; undefined if nothing does. */
  middle(): Vector3 | undefined {
    const sum = new Vector3();
    let count = 0;
    for (const { fixed, center, rows } of this.batches) {
      for (let k = 0; !fixed && k < rows.length; ++k, ++count) sum.add(new Vector3().fromBufferAttribute(center, k));
    }
    return count > 0 ? sum.divideScalar(count) : undefined;
  }

  /** Adds fixed bodies that are not much wider than `out`; wide ones become floors. Returns the lowest height. */
  frame(out: Extent): number {
    const one = new Box3();
    let lowest = Infinity;
    for (const batch of this.batches) for (let k = 0; k < batch.rows.length; ++k) lowest = Math.min(lowest, lowestOf(boundsOf(batch, k, one)));
    const moving = out.ball();
    const size = out.empty ? Infinity : moving.radius;
    const middle = new Vector3().fromArray(moving.center);
    for (const batch of this.batches) {
      if (!batch.fixed) continue;
      let wide = false;
      for (let k = 0; k < batch.rows.length; ++k) {
        boundsOf(batch, k, one);
        const far = middle.distanceTo(one.getCenter(new Vector3())) + 0.5 * one.getSize(new Vector3()).length();
        if (size === Infinity || far < kWide * size) addBox(out, one);
        const sides = one.getSize(new Vector3()).toArray();
        wide ||= sides.every((side, axis) => side > size || upward.getComponent(axis) !== 0);
      }
      batch.mesh.material.uniforms.receives!.value = wide;
      if (wide) batch.mesh.layers.disable(1);
      else batch.mesh.layers.enable(1);
    }
    return lowest;
  }

  dispose(): void {
    for (const { mesh } of this.batches) {
      mesh.geometry.dispose();
      mesh.material.dispose();
    }
    this.group.removeFromParent();
  }
}

function partOf(visual: Visual, topology: SystemTopology, first: number): Part {
  const shape = visual.shape!;
  const [x = 0, y = 0, z = 0] = shape.position;
  const [qw = 1, qx = 0, qy = 0, qz = 0] = shape.orientation;
  const [a = 1, b = a, c = a] = shape.size;
  const low = new Vector3(), high = new Vector3();
  let size: Part["size"] = [1, 1, 1];
  let kind = shape.kind;
  let radius: number;
  if (kind === "mesh") {
    kind = `mesh${visual.mesh}`;
    const points = floats(topology.meshes[visual.mesh]!.positions);
    const box = new Box3().setFromArray(points);
    low.copy(box.min);
    high.copy(box.max);
    radius = 0;
    for (let k = 0; k < points.length; k += 3) radius = Math.max(radius, Math.hypot(points[k]!, points[k + 1]!, points[k + 2]!));
  } else {
    const half: Part["size"] = kind === "box" ? [a, b, c] : kind === "sphere" ? [a, a, a] : kind === "capsule" ? [a, a + b, a] : [a, b, a];
    high.fromArray(half);
    low.copy(high).negate();
    size = kind === "capsule" ? [a, b, a] : half;
    radius = kind === "box" ? Math.hypot(a, b, c) : kind === "cylinder" ? Math.hypot(a, b) : half[1];
  }
  return { visual, palette: first + visual.group, kind, at: [x, y, z], turn: [qx, qy, qz, qw], size, low, high, radius: radius + Math.hypot(x, y, z) };
}

/** The height of the lowest corner. */
function lowestOf({ min, max }: Box3): number {
  return [0, 1, 2].reduce((sum, axis) => sum + Math.min(min.getComponent(axis) * upward.getComponent(axis), max.getComponent(axis) * upward.getComponent(axis)), 0);
}

function addBox(out: Extent, { min, max }: Box3): void {
  for (let corner = 0; corner < 8; ++corner) out.add(corner & 1 ? max.x : min.x, corner & 2 ? max.y : min.y, corner & 4 ? max.z : min.z);
}

/** Box around instance k as it is placed now. */
function boundsOf(batch: Batch, k: number, out: Box3): Box3 {
  const { low, high } = batch.parts[k]!;
  const t = batch.turn.array as Float32Array;
  const x = t[4 * k]!, y = t[4 * k + 1]!, z = t[4 * k + 2]!, w = t[4 * k + 3]!;
  const rows = [
    [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
  ];
  const middle = [0.5 * (low.x + high.x), 0.5 * (low.y + high.y), 0.5 * (low.z + high.z)];
  const half = [0.5 * (high.x - low.x), 0.5 * (high.y - low.y), 0.5 * (high.z - low.z)];
  const c = [0, 1, 2].map((e) => batch.center.array[3 * k + e]! + rows[e]!.reduce((sum, r, j) => sum + r * middle[j]!, 0));
  const h = rows.map((row) => row.reduce((sum, r, j) => sum + Math.abs(r) * half[j]!, 0));
  out.min.set(c[0]! - h[0]!, c[1]! - h[1]!, c[2]! - h[2]!);
  out.max.set(c[0]! + h[0]!, c[1]! + h[1]!, c[2]! + h[2]!);
  return out;
}

function baseGeometry(kind: string, count: number, topology: SystemTopology): BufferGeometry {
  const around = count > kMany ? 16 : 36;
  switch (kind) {
    case "box":
      return new BoxGeometry(2, 2, 2);
    case "sphere":
      return new SphereGeometry(1, around, around / 2);
    case "cylinder":
      return new CylinderGeometry(1, 1, 2, around);
    case "capsule": {
      // Half spheres about the origin, and which end each vertex belongs to.
      const geometry = new CapsuleGeometry(1, 2, around / 4, around);
      const p = geometry.getAttribute("position");
      const cap = new Float32Array(p.count);
      for (let k = 0; k < p.count; ++k) {
        cap[k] = Math.sign(p.getY(k));
        p.setY(k, p.getY(k) - cap[k]!);
      }
      return geometry.setAttribute("cap", new BufferAttribute(cap, 1));
    }
    default:
      return geometryOfMesh(topology.meshes[Number(kind.slice(4))]!);
  }
}

/** A number in [-1, 1] that differs between neighbouring rows. */
const shade = (row: number): number => (Math.imul(row + 1, 2654435761) >>> 8) / 8388608 - 1;

function colorOf({ visual, palette }: Part, row: number): Color {
  const [r, g, b] = visual.color;
  if (r !== undefined && g !== undefined && b !== undefined) return new Color().setRGB(r, g, b, SRGBColorSpace);
  const color = (motionColor.get(visual.motion) ?? paletteColor(palette)).clone();
  return visual.motion === Motion.DYNAMIC ? color.multiplyScalar(1 + 0.16 * shade(row)) : color;
}

function makeBatch(key: string, rows: Uint32Array, parts: Part[], topology: SystemTopology, floor: FloorUniforms): Batch {
  const [kind, role] = key.split(" ") as [string, string];
  const base = baseGeometry(kind, rows.length, topology);
  const geometry = new InstancedBufferGeometry();
  for (const name of ["position", "normal", "cap"]) if (base.hasAttribute(name)) geometry.setAttribute(name, base.getAttribute(name));
  geometry.setIndex(base.getIndex());
  geometry.instanceCount = rows.length;
  const size = new Float32Array(3 * rows.length);
  const tint = new Float32Array(3 * rows.length);
  rows.forEach((row, k) => {
    size.set(parts[k]!.size, 3 * k);
    colorOf(parts[k]!, row).toArray(tint, 3 * k);
  });
  const moving = (width: number): InstancedBufferAttribute => new InstancedBufferAttribute(new Float32Array(width * rows.length), width).setUsage(DynamicDrawUsage);
  const center = moving(3), turn = moving(4), value = moving(1);
  geometry.setAttribute("size", new InstancedBufferAttribute(size, 3));
  geometry.setAttribute("tint", new InstancedBufferAttribute(tint, 3));
  geometry.setAttribute("center", center).setAttribute("turn", turn).setAttribute("value", value);
  const glass = role === "sensor";
  const material = new ShaderMaterial({
    uniforms: { ...floor, ...lightUniforms, stops: rampUniform, byValue: { value: false }, receives: { value: false }, opacity: { value: glass ? 0.25 : 1 }, stripes: { value: kind === "sphere" } },
    vertexShader: bodyVertex,
    fragmentShader: bodyFragment,
    defines: kind === "capsule" ? { CAPSULE: "" } : {},
    transparent: glass,
    depthWrite: !glass,
  });
  const mesh = new Mesh(geometry, material);
  mesh.frustumCulled = false;
  if (!glass) mesh.layers.enable(1);
  const plain = parts.every(({ at, turn: t }) => at.every((c) => c === 0) && t[3] === 1);
  return { mesh, rows, parts, fixed: role === "fixed", plain, center, turn, value };
}
