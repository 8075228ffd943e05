// Where a grid is drawn: a grid of nodes has its vertices at the nodes; a grid of cells fills its box, with a vertex more half a
// cell beyond the outermost centres, which has their value, as probes have it (and as in the service's pictures).
import type { Lattice } from "../../client/gen/truestep/v1/stream_pb";

export class GridVertices {
  /** Rows along the axis, and vertices. */
  readonly rows: number;
  readonly count: number;
  /** Lattice units from the outermost row to the grid's edge. */
  readonly margin: number;

  constructor(lattice: Lattice, axis: number) {
    this.rows = lattice.counts[axis]!;
    this.margin = lattice.cells && this.rows > 1 ? 0.5 : 0;
    this.count = this.rows + 4 * this.margin;
  }

  /** The row along the axis that has the value of vertex `k`. */
  row(k: number): number {
    return this.margin === 0 ? k : Math.min(Math.max(k, 1), this.rows) - 1;
  }

  /** Lattice coordinate of vertex `k`, or of a point between two. */
  place(k: number): number {
    if (this.margin === 0) return k;
    const inside = Math.min(Math.max(k, 1), this.rows);
    return inside - 1 + this.margin * (k - inside);
  }
}
