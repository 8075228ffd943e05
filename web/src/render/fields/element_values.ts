// Values of elements as colours of triangles: which element a triangle shows, and its value.
import { uints, type FieldArray } from "../../client/decode";
import type { SystemTopology } from "../../client/gen/truestep/v1/stream_pb";
import { sizes } from "../values";

/** A value per triangle of the topology; NaN where its element has none. */
export function triangleValues(topology: Pick<SystemTopology, "triangles" | "triangleElements">, field: FieldArray): Float32Array {
  const elements = uints(topology.triangleElements);
  const values = sizes(field);
  return Float32Array.from({ length: topology.triangles.byteLength / 12 }, (_, k) => values[elements[k] ?? k] ?? NaN);
}
