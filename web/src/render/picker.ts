// Finds the point under the mouse by projecting every point (a multiply-add per coordinate, under a
// millisecond for 100,000), and the position that a dragged point should go to.
import { Matrix4, Plane, Ray, Vector3, type PerspectiveCamera } from "three";
import type { SystemView } from "./system_view";

export interface Pick {
  view: SystemView;
  index: number;
}

const matrix = new Matrix4();

/** The nearest point within `reach` CSS pixels of (x, y) in a width x height view; of several, the front one. */
export function pickPoint(views: Iterable<SystemView>, camera: PerspectiveCamera, x: number, y: number, width: number, height: number, reach: number): Pick | undefined {
  matrix.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
  const m = matrix.elements as unknown as Float64Array;
  const focal = (camera.projectionMatrix.elements[5]! * height) / 2;
  let best: Pick | undefined;
  let bestScore = Infinity;
  for (const view of views) {
    const p = view.positions;
    const reach_of = view.bodies?.reach;
    for (let index = 0; index < view.count; ++index) {
      // About half of a body's reach: the corners of a long body would be beside it.
      const radius = reach_of ? 0.6 * (reach_of[index] ?? -1) : view.pointRadius;
      if (radius < 0) continue;
      const px = p[3 * index]!, py = p[3 * index + 1]!, pz = p[3 * index + 2]!;
      const w = m[3]! * px + m[7]! * py + m[11]! * pz + m[15]!;
      if (w <= 0) continue;
      const dx = (0.5 + (0.5 * (m[0]! * px + m[4]! * py + m[8]! * pz + m[12]!)) / w) * width - x;
      const dy = (0.5 - (0.5 * (m[1]! * px + m[5]! * py + m[9]! * pz + m[13]!)) / w) * height - y;
      const distance = Math.sqrt(dx * dx + dy * dy);
      const limit = Math.max(reach, (radius * focal) / w);
      if (distance > limit) continue;
      // A point much nearer to the eye wins over one a few pixels nearer to the mouse.
      const score = distance / limit + 3 * Math.log(w);
      if (score < bestScore) {
        bestScore = score;
        best = { view, index };
      }
    }
  }
  return best;
}

/** Where the point of `pick` is now. */
export function pointOf(pick: Pick, out: Vector3): Vector3 {
  return out.fromArray(pick.view.positions, 3 * pick.index);
}

const plane = new Plane();
const ray = new Ray();
const normal = new Vector3();

/** Where the mouse at normalised device coordinates (x, y) meets the plane through `anchor` that faces the eye. */
export function dragTarget(camera: PerspectiveCamera, anchor: Vector3, x: number, y: number, out: Vector3): Vector3 | undefined {
  camera.getWorldDirection(normal);
  plane.setFromNormalAndCoplanarPoint(normal, anchor);
  ray.origin.setFromMatrixPosition(camera.matrixWorld);
  ray.direction.set(x, y, 0.5).unproject(camera).sub(ray.origin).normalize();
  return ray.intersectPlane(plane, out) ?? undefined;
}
