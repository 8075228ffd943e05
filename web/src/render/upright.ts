// Which way is up on the screen: the axis against gravity, or the one that a scene's own camera names, otherwise y. Light,
// ground, heights and the camera's turning follow it. One scene is on the screen, so there is one direction, changed in place.
import { Quaternion, Vector3, type IUniform } from "three";

type Vec = readonly number[];

const y = new Vector3(0, 1, 0);
/** Towards the light where y is up. */
const key = new Vector3(0.42, 0.8, 0.43).normalize();

export const upward = y.clone();
/** Towards the light. */
export const keyDirection = key.clone();
/** Turns y to `upward`. */
export const turnUp = new Quaternion();
/** For every material that uses shadeGlsl. */
export const lightUniforms = { upward: { value: upward }, keyLight: { value: keyDirection }, least: { value: 0 } } satisfies Record<string, IUniform>;

/** The axis that is up in a scene, as in the service's pictures; gravity along no axis leaves y. */
export function upOf(gravity: Vec | undefined, camera?: Vec): [number, number, number] {
  for (const [wanted, sign] of [[camera, 1], [gravity, -1]] as const) {
    const length = Math.hypot(...(wanted ?? []));
    if (!(length > 0)) continue;
    const along = wanted!.findIndex((c) => Math.abs(c) > 0.9 * length);
    // A camera whose up is y says nothing: that is its default.
    if (along < 0 || (sign === 1 && along === 1)) continue;
    const up: [number, number, number] = [0, 0, 0];
    up[along] = along === 1 || sign * wanted![along]! > 0 ? 1 : -1;
    return up;
  }
  return [0, 1, 0];
}

export function setUpright(up: Vec): void {
  upward.fromArray(up as number[]);
  turnUp.setFromUnitVectors(y, upward);
  keyDirection.copy(key).applyQuaternion(turnUp);
}

/** m above the origin. */
export const heightOf = (x: number, y: number, z: number): number => x * upward.x + y * upward.y + z * upward.z;

/** A direction given for y up. */
export const turned = (x: number, y: number, z: number): Vector3 => new Vector3(x, y, z).applyQuaternion(turnUp);
