// Whether a new topology of a system draws the same things as the last one.
import type { SystemTopology } from "../client/gen/truestep/v1/stream_pb";

const sameBytes = (a: Uint8Array, b: Uint8Array): boolean => a.length === b.length && a.every((byte, k) => byte === b[k]);

export function sameTopology(a: SystemTopology, b: SystemTopology): boolean {
  return a.pointRadius === b.pointRadius && sameBytes(a.lines, b.lines) && sameBytes(a.triangles, b.triangles) && sameBytes(a.triangleElements, b.triangleElements) && sameBytes(a.instances, b.instances) && a.visuals.length === b.visuals.length && a.color.join() === b.color.join();
}
