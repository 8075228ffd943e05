// The scene's solid shapes on the screen, in the order of the topology; the ground is drawn by itself.
import { Group, Mesh, type Object3D } from "three";
import { floats } from "../client/decode";
import type { Mesh as MeshData, Shape } from "../client/gen/truestep/v1/stream_pb";
import type { Extent } from "./extent";
import { makeShape, placeShape } from "./shapes";

export class ShapeGroup {
  readonly object = new Group();
  /** Undefined where nothing is drawn. */
  private drawn: (Object3D | undefined)[] = [];

  /** Draws `shapes` and the meshes of some instead of those before them; planes are 2 `extent` (m) wide. */
  set(shapes: Shape[], meshes: MeshData[], extent: number): void {
    for (const one of this.drawn) {
      one?.traverse((child) => child instanceof Mesh && child.geometry.dispose());
      one?.removeFromParent();
    }
    this.drawn = shapes.map((shape) => makeShape(shape, meshes, extent));
    for (const one of this.drawn) if (one) this.object.add(one);
  }

  /** Moves the shapes to where they are now. */
  move(shapes: Shape[]): void {
    shapes.forEach((shape, k) => {
      const one = this.drawn[k];
      if (one) placeShape(one, shape);
    });
  }
}

/** Adds a shape's ball; a plane has none. */
export function reachOfShape(out: Extent, { kind, position, size, mesh }: Shape, meshes: MeshData[]): void {
  const [x = 0, y = 0, z = 0] = position;
  const [a = 1, b = a, c = a] = size;
  if (kind === "sphere") out.add(x, y, z, a);
  else if (kind === "box") out.add(x, y, z, 0.9 * Math.hypot(a, b, c));
  else if (kind === "capsule" || kind === "cylinder") out.add(x, y, z, a + b);
  else if (kind === "mesh" && meshes[mesh]) {
    const at = floats(meshes[mesh].positions);
    let farthest = 0;
    for (let k = 0; k + 2 < at.length; k += 3) farthest = Math.max(farthest, Math.hypot(at[k]!, at[k + 1]!, at[k + 2]!));
    out.add(x, y, z, 0.9 * farthest);
  }
}
