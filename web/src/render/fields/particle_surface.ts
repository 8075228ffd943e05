// The smooth surface of a liquid given by particles, as in the server's pictures (engine/geometry/particle_surface.h):
// each particle spreads its volume over an ellipsoid that follows its neighbours (after Yu & Turk 2013), surface nets
// (Gibson 1998) extract the level 1/2 on a lattice, and Taubin smoothing (1995) removes ripples. The lattice is coarser.

const kReach = 2; // spacings: neighbours this near shape a particle
const kSupport = 2.5; // spacings: kernel radius of a particle that is not stretched
const kInside = 0.15; // covariance along an axis inside the liquid, over the squared reach
const kLeastStretch = 0.15;
const kWhole = 25; // this many neighbours determine a shape fully
const kLone = 0.5; // size of a drop, relative to a particle inside the liquid
const kLevel = 0.5;
const kShrink = 0.5;
const kGrow = -0.53;
const kMostBins = 2e6;

export interface ParticleSurface {
  /** n x 3, m. */
  positions: Float32Array;
  /** n, or undefined if the particles have none. */
  values: Float32Array | undefined;
  /** Three per triangle, anticlockwise seen from outside. */
  triangles: Uint32Array;
}

interface Box {
  low: number[];
  size: number;
  count: number[];
}

/** A box of cubes `size` wide, or wider if that would be too many. */
function boxOf(low: number[], high: number[], size: number, extra: number, most: number): Box {
  for (;;) {
    const count = low.map((l, a) => Math.floor((high[a]! - l) / size) + 1 + extra);
    if (count[0]! * count[1]! * count[2]! <= most) return { low, size, count };
    size *= 1.25;
  }
}

/** The stretch of each particle in `kept`, as symmetric 3 x 3 matrices xx yy zz xy xz yz. */
function stretches(x: Float32Array, kept: Uint32Array, low: number[], high: number[], spacing: number): Float32Array {
  const reach = kReach * spacing;
  const { size, count } = boxOf(low, high, reach, 0, kMostBins);
  const [nx, ny] = [count[0]!, count[1]!];
  const along = (p: number, a: number): number => Math.min(Math.max(Math.floor((p - low[a]!) / size), 0), count[a]! - 1);
  const start = new Uint32Array(nx * ny * count[2]! + 1);
  const bin = new Uint32Array(kept.length);
  kept.forEach((i, k) => {
    bin[k] = along(x[3 * i]!, 0) + nx * (along(x[3 * i + 1]!, 1) + ny * along(x[3 * i + 2]!, 2));
    ++start[bin[k]! + 1]!;
  });
  for (let k = 1; k < start.length; ++k) start[k]! += start[k - 1]!;
  const next = start.slice(0, -1);
  const order = new Uint32Array(kept.length);
  kept.forEach((i, k) => (order[next[bin[k]!]!++] = i));
  const out = new Float32Array(6 * kept.length);
  const scale = 1 / (kInside * reach * reach);
  for (let k = 0; k < kept.length; ++k) {
    const [px, py, pz] = [x[3 * kept[k]!]!, x[3 * kept[k]! + 1]!, x[3 * kept[k]! + 2]!];
    let sum = 0, near = 0, mx = 0, my = 0, mz = 0, xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
    const [first, last] = [along(px - reach, 0), along(px + reach, 0)];
    for (let c = along(pz - reach, 2); c <= along(pz + reach, 2); ++c) {
      for (let b = along(py - reach, 1); b <= along(py + reach, 1); ++b) {
        const row = nx * (b + ny * c);
        for (let at = start[row + first]!; at < start[row + last + 1]!; ++at) {
          const j = 3 * order[at]!;
          const u = x[j]! - px, v = x[j + 1]! - py, w = x[j + 2]! - pz;
          const q = Math.sqrt(u * u + v * v + w * w) / reach;
          if (q >= 1) continue;
          const f = 1 - q * q * q;
          sum += f; ++near;
          mx += f * u; my += f * v; mz += f * w;
          xx += f * u * u; yy += f * v * v; zz += f * w * w;
          xy += f * u * v; xz += f * u * w; yz += f * v * w;
        }
      }
    }
    mx /= sum; my /= sum; mz /= sum;
    const trust = Math.min((near - 1) / kWhole, 1);
    const own = trust * kLeastStretch + (1 - trust) * kLone;
    out[6 * k] = trust * scale * (xx / sum - mx * mx) + own;
    out[6 * k + 1] = trust * scale * (yy / sum - my * my) + own;
    out[6 * k + 2] = trust * scale * (zz / sum - mz * mz) + own;
    out[6 * k + 3] = trust * scale * (xy / sum - mx * my);
    out[6 * k + 4] = trust * scale * (xz / sum - mx * mz);
    out[6 * k + 5] = trust * scale * (yz / sum - my * mz);
  }
  return out;
}

/** A vertex in every cell, and a quad around every edge, that the level crosses. */
function surfaceNets({ low, size, count }: Box, field: Float32Array, sums: Float32Array | undefined): ParticleSurface {
  const [nx, ny, nz] = count as [number, number, number];
  const steps = [1, nx, nx * ny];
  const places: number[] = [];
  const values: number[] = [];
  const triangles: number[] = [];
  let here = new Int32Array(nx * ny).fill(-1);
  let before = new Int32Array(nx * ny).fill(-1);
  const corner = new Float32Array(8);
  const quad = (a: number, b: number, c: number, d: number, outward: boolean): void => {
    if (outward) triangles.push(a, b, c, a, c, d);
    else triangles.push(a, d, c, a, c, b);
  };
  for (let k = 0; k + 1 < nz; ++k) {
    [here, before] = [before, here];
    here.fill(-1);
    for (let j = 0; j + 1 < ny; ++j) {
      for (let i = 0; i + 1 < nx; ++i) {
        const flat = i + nx * j;
        const node = flat + nx * ny * k;
        let inside = 0;
        for (let c = 0; c < 8; ++c) {
          corner[c] = field[node + (c & 1) + (c & 2 ? nx : 0) + (c & 4 ? nx * ny : 0)]! - kLevel;
          if (corner[c]! > 0) ++inside;
        }
        if (inside === 0 || inside === 8) continue;
        const sum = [0, 0, 0];
        let crossings = 0;
        for (let c = 0; c < 8; ++c) {
          for (let a = 0; a < 3; ++a) {
            const d = c | (1 << a);
            if (d === c || corner[c]! > 0 === corner[d]! > 0) continue;
            for (let b = 0; b < 3; ++b) sum[b]! += b === a ? corner[c]! / (corner[c]! - corner[d]!) : (c >> b) & 1;
            ++crossings;
          }
        }
        here[flat] = places.length / 3;
        places.push(low[0]! + size * (i + sum[0]! / crossings), low[1]! + size * (j + sum[1]! / crossings), low[2]! + size * (k + sum[2]! / crossings));
        if (sums) {
          let value = 0, weight = 0;
          for (let c = 0; c < 8; ++c) {
            const at = node + (c & 1) + (c & 2 ? nx : 0) + (c & 4 ? nx * ny : 0);
            value += sums[at]!;
            weight += field[at]!;
          }
          values.push(value / weight);
        }
        const within = corner[0]! > 0;
        const [a, b, c] = [here[flat]!, flat - steps[1]!, flat - 1];
        if (j > 0 && k > 0 && within !== corner[1]! > 0) quad(a, here[b]!, before[b]!, before[flat]!, within);
        if (i > 0 && k > 0 && within !== corner[2]! > 0) quad(a, before[flat]!, before[c]!, here[c]!, within);
        if (i > 0 && j > 0 && within !== corner[4]! > 0) quad(a, here[c]!, here[c - nx]!, here[b]!, within);
      }
    }
  }
  return { positions: Float32Array.from(places), values: sums ? Float32Array.from(values) : undefined, triangles: Uint32Array.from(triangles) };
}

/** Moves vertices towards the mean of their neighbours, then farther back. */
function smooth({ positions: x, triangles: t }: ParticleSurface, rounds: number): void {
  const mean = new Float32Array(x.length);
  const count = new Float32Array(x.length / 3);
  for (let round = 0; round < 2 * rounds; ++round) {
    mean.fill(0);
    count.fill(0);
    for (let k = 0; k < t.length; ++k) {
      const a = t[k]!;
      const b = t[k % 3 === 2 ? k - 2 : k + 1]!;
      for (let c = 0; c < 3; ++c) mean[3 * a + c]! += x[3 * b + c]!;
      ++count[a]!;
    }
    const step = round % 2 === 0 ? kShrink : kGrow;
    for (let k = 0; k < x.length; ++k) {
      const near = count[Math.floor(k / 3)]!;
      if (near > 0) x[k]! += step * (mean[k]! / near - x[k]!);
    }
  }
}

/**
 * The surface of `count` particles at positions x, y, z (m), `spacing` apart at rest. `values` has a number for each, or
 * is undefined. `cell` is the lattice's cell width, enlarged if there would be more than `mostNodes` nodes.
 */
export function particleSurface(x: Float32Array, count: number, values: ArrayLike<number> | undefined, spacing: number, cell: number, mostNodes = 1e6): ParticleSurface {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  const finite: number[] = [];
  for (let i = 0; i < count; ++i) {
    if (!Number.isFinite(x[3 * i]! + x[3 * i + 1]! + x[3 * i + 2]!)) continue;
    finite.push(i);
    for (let a = 0; a < 3; ++a) {
      low[a] = Math.min(low[a]!, x[3 * i + a]!);
      high[a] = Math.max(high[a]!, x[3 * i + a]!);
    }
  }
  if (finite.length === 0 || !(spacing > 0) || !(cell > 0)) return { positions: new Float32Array(0), values: undefined, triangles: new Uint32Array(0) };
  const kept = Uint32Array.from(finite);
  const shapes = stretches(x, kept, low, high, spacing);
  const radius = kSupport * spacing;
  const margin = 1.5 * radius + cell;
  const box = boxOf(low.map((l) => l - margin), high.map((h) => h + margin), cell, 2, mostNodes);
  const [nx, ny] = [box.count[0]!, box.count[1]!];
  const field = new Float32Array(nx * ny * box.count[2]!);
  const sums = values ? new Float32Array(field.length) : undefined;
  const first = [0, 0, 0];
  const last = [0, 0, 0];
  for (let n = 0; n < kept.length; ++n) {
    const i = kept[n]!;
    const [xx, yy, zz, xy, xz, yz] = shapes.subarray(6 * n, 6 * n + 6) as unknown as [number, number, number, number, number, number];
    const det = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
    if (!(det > 1e-6)) continue;
    const gxx = (yy * zz - yz * yz) / det, gyy = (xx * zz - xz * xz) / det, gzz = (xx * yy - xy * xy) / det;
    const gxy = (xz * yz - xy * zz) / det, gxz = (xy * yz - yy * xz) / det, gyz = (xy * xz - xx * yz) / det;
    const reach = [Math.hypot(xx, xy, xz), Math.hypot(xy, yy, yz), Math.hypot(xz, yz, zz)];
    for (let a = 0; a < 3; ++a) {
      const at = (x[3 * i + a]! - box.low[a]!) / box.size;
      const far = (radius * reach[a]!) / box.size;
      first[a] = Math.max(Math.ceil(at - far), 0);
      last[a] = Math.min(Math.floor(at + far), box.count[a]! - 1);
    }
    // The cubic spline is normalized by 8 / pi in space.
    const share = 8 / Math.PI / (kSupport ** 3 * det);
    const value = values ? (Number.isFinite(values[i]!) ? values[i]! : 0) : 0;
    for (let c = first[2]!; c <= last[2]!; ++c) {
      const w = (box.low[2]! + c * box.size - x[3 * i + 2]!) / radius;
      for (let b = first[1]!; b <= last[1]!; ++b) {
        const v = (box.low[1]! + b * box.size - x[3 * i + 1]!) / radius;
        const row = nx * (b + ny * c);
        for (let a = first[0]!; a <= last[0]!; ++a) {
          const u = (box.low[0]! + a * box.size - x[3 * i]!) / radius;
          const p = gxx * u + gxy * v + gxz * w, q = gxy * u + gyy * v + gyz * w, r = gxz * u + gyz * v + gzz * w;
          const square = p * p + q * q + r * r;
          if (square >= 1) continue;
          const s = Math.sqrt(square), rest = 1 - s;
          const phi = share * (s < 0.5 ? 6 * s * s * (s - 1) + 1 : 2 * rest * rest * rest);
          field[row + a]! += phi;
          if (sums) sums[row + a]! += phi * value;
        }
      }
    }
  }
  const out = surfaceNets(box, field, sums);
  smooth(out, 4);
  return out;
}
