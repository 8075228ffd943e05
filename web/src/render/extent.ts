// The extent of a scene as the farthest things seen so far in 26 directions, and the position from which a camera sees
// all of them. Much tighter than a box, because it keeps positions where something was.

type Vec = readonly [number, number, number];

const dot = (a: Vec, b: Vec): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

const directions: Vec[] = [];
for (let x = -1; x <= 1; ++x) {
  for (let y = -1; y <= 1; ++y) {
    for (let z = -1; z <= 1; ++z) {
      const length = Math.hypot(x, y, z);
      if (length > 0) directions.push([x / length, y / length, z / length]);
    }
  }
}

const kSamples = 1500; // of a cloud

/** Right, up and backwards of a camera, and the tangents of half its free angles. */
export interface Frustum {
  right: Vec;
  above: Vec;
  back: Vec;
  kx: number;
  ky: number;
}

export class Extent {
  private readonly reach = new Float64Array(directions.length).fill(-Infinity);
  /** x, y, z and radius of the farthest thing in each direction. */
  private readonly places = new Float64Array(4 * directions.length);

  clear(): void {
    this.reach.fill(-Infinity);
  }

  get empty(): boolean {
    return this.reach[0] === -Infinity;
  }

  /** Adds a ball. */
  add(x: number, y: number, z: number, radius = 0): void {
    if (!Number.isFinite(x + y + z + radius)) return;
    directions.forEach((d, k) => this.offer(k, dot(d, [x, y, z]) + radius, x, y, z, radius));
  }

  /** Adds what `other` has seen. */
  merge(other: Extent): void {
    if (!other.empty) other.forEach((x, y, z, r) => this.add(x, y, z, r));
  }

  /** Adds a cloud of points; of many, the outermost half percent in each direction are ignored. */
  addCloud(positions: ArrayLike<number>, count: number, radius: number, strays: boolean): void {
    const step = Math.max(1, Math.floor(count / kSamples));
    const rows: number[] = [];
    for (let k = 0; k < count; k += step) if (Number.isFinite(positions[3 * k]! + positions[3 * k + 1]! + positions[3 * k + 2]!)) rows.push(k);
    if (rows.length === 0) return;
    const aside = strays ? Math.floor(rows.length / 200) : 0;
    const far = new Float64Array(rows.length);
    directions.forEach((d, k) => {
      rows.forEach((row, i) => (far[i] = d[0] * positions[3 * row]! + d[1] * positions[3 * row + 1]! + d[2] * positions[3 * row + 2]!));
      let at = 0;
      if (aside === 0) {
        for (let i = 1; i < far.length; ++i) if (far[i]! > far[at]!) at = i;
      } else {
        const wanted = Float64Array.from(far).sort()[far.length - 1 - aside]!;
        at = far.indexOf(wanted);
      }
      const row = 3 * rows[at]!;
      this.offer(k, far[at]! + radius, positions[row]!, positions[row + 1]!, positions[row + 2]!, radius);
    });
  }

  forEach(visit: (x: number, y: number, z: number, radius: number) => void): void {
    const p = this.places;
    for (let k = 0; k < p.length; k += 4) if (this.reach[k / 4] !== -Infinity) visit(p[k]!, p[k + 1]!, p[k + 2]!, p[k + 3]!);
  }

  /** Maximum and minimum along an axis (0, 1, 2). */
  along(axis: number): [number, number] {
    let low = Infinity;
    let high = -Infinity;
    this.forEach((x, y, z, r) => {
      const c = axis === 0 ? x : axis === 1 ? y : z;
      low = Math.min(low, c - r);
      high = Math.max(high, c + r);
    });
    return [low, high];
  }

  /** The farthest point along a unit vector. */
  top(up: Vec): [number, number, number] {
    let best: [number, number, number] = [0, 0, 0];
    let most = -Infinity;
    this.forEach((x, y, z, r) => {
      const far = dot(up, [x, y, z]) + r;
      if (far <= most) return;
      most = far;
      best = [x + r * up[0], y + r * up[1], z + r * up[2]];
    });
    return best;
  }

  /** The least distance along a unit vector. */
  bottom(up: Vec): number {
    let low = Infinity;
    this.forEach((x, y, z, r) => (low = Math.min(low, dot(up, [x, y, z]) - r)));
    return low;
  }

  /** Centre of the box around everything, and half its diagonal. */
  ball(): { center: [number, number, number]; radius: number } {
    if (this.empty) return { center: [0, 0, 0], radius: 0 };
    const sides = [0, 1, 2].map((axis) => this.along(axis));
    const center = sides.map(([low, high]) => (low + high) / 2) as [number, number, number];
    return { center, radius: Math.hypot(...sides.map(([low, high]) => (high - low) / 2)) };
  }

  /**
   * The nearest position from which a camera looking along -back sees everything; `least` (m) is the smallest
   * height or width that it may see. A ball of radius r at c is seen if s (c . axis) + k (c . back) + r sqrt(1 + k^2)
   * is at most s x + k d for s = +1 and -1: four planes through the eye.
   */
  fit({ right, above, back, kx, ky }: Frustum, least: number): { eye: [number, number, number]; target: [number, number, number] } {
    const slabs = [-Infinity, -Infinity, -Infinity, -Infinity];
    let near = -Infinity;
    let far = Infinity;
    this.forEach((x, y, z, r) => {
      const c: Vec = [x, y, z];
      const depth = dot(c, back);
      const rx = kx * depth + r * Math.hypot(1, kx);
      const ry = ky * depth + r * Math.hypot(1, ky);
      const all = [dot(c, right) + rx, rx - dot(c, right), dot(c, above) + ry, ry - dot(c, above)];
      all.forEach((value, k) => (slabs[k] = Math.max(slabs[k]!, value)));
      near = Math.max(near, depth + r);
      far = Math.min(far, depth - r);
    });
    if (near < far) [slabs.fill(0), (near = far = 0)];
    const [a, b, c, d] = slabs as [number, number, number, number];
    const x = (a - b) / 2;
    const y = (c - d) / 2;
    const middle = (near + far) / 2;
    const away = Math.max((a + b) / (2 * kx), (c + d) / (2 * ky), middle + least / (2 * Math.min(kx, ky)), near + 0.02 * (near - far));
    const at = (depth: number): [number, number, number] => [0, 1, 2].map((e) => x * right[e]! + y * above[e]! + depth * back[e]!) as [number, number, number];
    return { eye: at(away), target: at(middle) };
  }

  /** True when everything is inside the frustum of a camera at `eye`. */
  fits({ right, above, back, kx, ky }: Frustum, eye: Vec): boolean {
    let inside = true;
    this.forEach((x, y, z, r) => {
      const q: Vec = [x - eye[0], y - eye[1], z - eye[2]];
      const depth = -dot(q, back);
      const over = (k: number, axis: Vec): number => Math.abs(dot(q, axis)) + r * Math.hypot(1, k) - k * depth;
      if (over(kx, right) > 0 || over(ky, above) > 0) inside = false;
    });
    return inside;
  }

  private offer(k: number, reach: number, x: number, y: number, z: number, radius: number): void {
    if (!(reach > this.reach[k]!)) return;
    this.reach[k] = reach;
    this.places.set([x, y, z, radius], 4 * k);
  }
}
