// Streamlines that keep apart, by the rule of the service's pictures (engine/math/even_streamlines.cc) and point for point
// its lines: a line starts only at some distance from those before it, and ends where it comes closer to one of them, or to
// its own beginning, than half of that. Classical Runge-Kutta method on the bilinear interpolant, in lattice units.
// Distances are square roots of sums, because Math.hypot differs between browsers.
import type { PlaneField } from "../plane_lines";

const kStep = 0.5; // of a line
const kApart = 0.5; // least distance between lines, in spacings of their seeds

const apartBy = (x: number, y: number): number => Math.sqrt(x * x + y * y);

/** Unit direction at a position, written to `out`; false outside and where the field vanishes or is not finite. */
function direction({ nx, ny, u, v, margin = 0 }: PlaneField, x: number, y: number, out: Float64Array): boolean {
  if (!(x >= -margin && y >= -margin && x <= nx - 1 + margin && y <= ny - 1 + margin)) return false;
  x = Math.min(Math.max(x, 0), nx - 1);
  y = Math.min(Math.max(y, 0), ny - 1);
  const i = Math.min(Math.floor(x), nx - 2), j = Math.min(Math.floor(y), ny - 2);
  const s = x - i, t = y - j, k = i + nx * j;
  const a = (1 - t) * ((1 - s) * u[k]! + s * u[k + 1]!) + t * ((1 - s) * u[k + nx]! + s * u[k + nx + 1]!);
  const b = (1 - t) * ((1 - s) * v[k]! + s * v[k + 1]!) + t * ((1 - s) * v[k + nx]! + s * v[k + nx + 1]!);
  const size = apartBy(a, b);
  if (!(size > 0) || !Number.isFinite(size)) return false;
  out[0] = a / size;
  out[1] = b / size;
  return true;
}

/** The line through (x, y), along the field for h > 0 and against it for h < 0, until it leaves, stops or has `most` points. */
export function streamline(field: PlaneField, x: number, y: number, h: number, most: number): number[] {
  const line = [x, y];
  const [a, b, c, d] = [0, 1, 2, 3].map(() => new Float64Array(2)) as [Float64Array, Float64Array, Float64Array, Float64Array];
  while (line.length < 2 * most) {
    if (!direction(field, x, y, a)) break;
    if (!direction(field, x + 0.5 * h * a[0]!, y + 0.5 * h * a[1]!, b)) break;
    if (!direction(field, x + 0.5 * h * b[0]!, y + 0.5 * h * b[1]!, c)) break;
    if (!direction(field, x + h * c[0]!, y + h * c[1]!, d)) break;
    x += (h / 6) * (a[0]! + 2 * b[0]! + 2 * c[0]! + d[0]!);
    y += (h / 6) * (a[1]! + 2 * b[1]! + 2 * c[1]! + d[1]!);
    line.push(x, y);
  }
  return line;
}

/** Points in squares as wide as lines are apart. */
class Near {
  private readonly columns: number;
  private readonly rows: number;
  private readonly squares = new Map<number, number[]>();

  constructor({ nx, ny }: PlaneField, private readonly apart: number) {
    this.columns = Math.floor(nx / apart) + 1;
    this.rows = Math.floor(ny / apart) + 1;
  }

  add(x: number, y: number): void {
    const square = this.square(x, this.columns) + this.columns * this.square(y, this.rows);
    const points = this.squares.get(square);
    if (points) points.push(x, y);
    else this.squares.set(square, [x, y]);
  }

  anyWithin(x: number, y: number, distance: number): boolean {
    const i = this.square(x, this.columns), j = this.square(y, this.rows);
    for (let row = Math.max(j - 1, 0); row <= Math.min(j + 1, this.rows - 1); ++row) {
      for (let column = Math.max(i - 1, 0); column <= Math.min(i + 1, this.columns - 1); ++column) {
        const points = this.squares.get(column + this.columns * row) ?? [];
        for (let k = 0; k < points.length; k += 2) if (apartBy(x - points[k]!, y - points[k + 1]!) < distance) return true;
      }
    }
    return false;
  }

  private square(x: number, n: number): number {
    return Math.min(Math.floor(Math.max(0, x / this.apart)), n - 1);
  }
}

/** Lines (x, y of each point) from at most `count` seeds spread over the field; a line in two directions is two of them. */
export function evenStreamlines(field: PlaneField, count: number): number[][] {
  const { nx, ny, margin = 0 } = field;
  const width = nx - 1 + 2 * margin, height = ny - 1 + 2 * margin;
  const spacing = Math.sqrt((width * height) / count);
  const apart = Math.max(1, kApart * spacing);
  const columns = Math.max(1, Math.round(width / spacing));
  const rows = Math.ceil(count / columns);
  const near = new Near(field, apart);
  const out: number[][] = [];
  for (let seed = 0; seed < count; ++seed) {
    const x = (((seed % columns) + 0.5) / columns) * width - margin;
    const y = ((Math.floor(seed / columns) + 0.5) / rows) * height - margin;
    if (near.anyWithin(x, y, apart)) continue;
    const added: number[] = [];
    for (const h of [kStep, -kStep]) {
      const { line, closed } = cut(field, streamline(field, x, y, h, 2 * (nx + ny)), near, apart);
      added.push(...line);
      if (line.length > 2) out.push(line);
      if (closed) break;
    }
    for (let k = 0; k < added.length; k += 2) near.add(added[k]!, added[k + 1]!);
  }
  return out;
}

/** The part of a line that is far enough from others and from its own beginning; `closed` if it comes back to its seed. */
function cut(field: PlaneField, line: number[], others: Near, apart: number): { line: number[]; closed: boolean } {
  const [x, y] = line as [number, number];
  const itself = new Near(field, apart);
  // How far behind itself a line does not look.
  const own = Math.floor((2 * apart) / kStep);
  for (let n = 1; 2 * n < line.length; ++n) {
    const [a, b] = [line[2 * n]!, line[2 * n + 1]!];
    if (n > own) itself.add(line[2 * (n - own - 1)]!, line[2 * (n - own) - 1]!);
    const home = apartBy(a - x, b - y);
    if (n > own && home < kStep) return { line: [...line.slice(0, 2 * n), x, y], closed: true };
    // A line that comes back beside its beginning ends there; one that closes may come all the way.
    if (others.anyWithin(a, b, 0.5 * apart) || (itself.anyWithin(a, b, 0.25 * apart) && home > apart)) return { line: line.slice(0, 2 * n), closed: false };
  }
  return { line, closed: false };
}
