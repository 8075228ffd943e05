// Lines over a plane of a lattice, as the service's pictures draw them: level lines by marching squares (saddles by
// the mean of the corners) and arrows; streamlines.ts has those that follow a flow. All in lattice coordinates, x fastest;
// a segment is four numbers: both ends.

export interface Plane {
  nx: number;
  ny: number;
}

/** Segments of the contour where `values` equal `level`. */
export function levelLine(values: ArrayLike<number>, { nx, ny }: Plane, level: number, out: number[]): void {
  const px = [0, 1, 1, 0];
  const py = [0, 0, 1, 1];
  const crossing = new Float64Array(8);
  for (let y = 0; y + 1 < ny; ++y) {
    for (let x = 0; x + 1 < nx; ++x) {
      const k = x + nx * y;
      const v = [values[k]! - level, values[k + 1]! - level, values[k + nx + 1]! - level, values[k + nx]! - level] as const;
      const sum = v[0] + v[1] + v[2] + v[3];
      if (!Number.isFinite(sum)) continue;
      const edges: number[] = [];
      for (let e = 0; e < 4; ++e) {
        const f = (e + 1) % 4;
        const a = v[e]!, b = v[f]!;
        if (a < 0 === b < 0) continue;
        const t = a / (a - b);
        crossing[2 * e] = x + px[e]! + t * (px[f]! - px[e]!);
        crossing[2 * e + 1] = y + py[e]! + t * (py[f]! - py[e]!);
        edges.push(e);
      }
      const piece = (e: number, f: number): void => void out.push(crossing[2 * e]!, crossing[2 * e + 1]!, crossing[2 * f]!, crossing[2 * f + 1]!);
      if (edges.length === 2) piece(edges[0]!, edges[1]!);
      if (edges.length !== 4) continue;
      const joined = sum < 0 === v[0] < 0;
      piece(0, joined ? 1 : 3);
      piece(2, joined ? 3 : 1);
    }
  }
}

/** A vector per node, in lattice units: `u` along x, `v` along y. */
export interface PlaneField extends Plane {
  u: ArrayLike<number>;
  v: ArrayLike<number>;
  /** How far the field goes on beyond its outermost nodes, with their values. */
  margin?: number;
}

const kMostArrows = 28; // along a side

/** Arrows at every few nodes; one of magnitude `most` is 0.9 of their spacing long. */
export function arrows({ nx, ny, u, v }: PlaneField, most: number, out: number[]): void {
  if (!(most > 0)) return;
  const stride = Math.max(1, Math.ceil(nx / kMostArrows), Math.ceil(ny / kMostArrows));
  const scale = (0.9 * stride) / most;
  for (let j = stride >> 1; j < ny; j += stride) {
    for (let i = stride >> 1; i < nx; i += stride) {
      const dx = scale * u[i + nx * j]!, dy = scale * v[i + nx * j]!;
      if (!(Math.hypot(dx, dy) > 0.02 * stride)) continue;
      const bx = i + dx, by = j + dy;
      out.push(i, j, bx, by);
      for (const side of [0.18, -0.18]) out.push(bx, by, bx - 0.3 * dx - side * dy, by - 0.3 * dy + side * dx);
    }
  }
}
