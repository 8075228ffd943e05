// One number per row of a part, for colours.
import type { FieldArray } from "../client/decode";

/** Fields by what they mean. */
export interface Names {
  position: string | undefined;
  orientation: string | undefined;
  asleep: string | undefined;
  velocity: string | undefined;
}

export const mine = (fields: FieldArray[], id: string): FieldArray[] => fields.filter((field) => field.system === id);

/** One number per row: the value, or the length of a vector. */
export function sizes({ count, width, data }: FieldArray): Float32Array {
  const out = new Float32Array(count);
  for (let r = 0; r < count; ++r) {
    let sum = 0;
    for (let c = 0; c < width; ++c) sum += data[r * width + c]! ** 2;
    out[r] = width === 1 ? data[r]! : Math.sqrt(sum);
  }
  return out;
}

export function extremes(values: ArrayLike<number>): [number, number] {
  let low = Infinity;
  let high = -Infinity;
  for (let k = 0; k < values.length; ++k) {
    if (values[k]! < low) low = values[k]!;
    if (values[k]! > high) high = values[k]!;
  }
  return low <= high ? [low, high] : [0, 1];
}

/** A value per point: of the named field, its length if it is a vector, and of velocity if speed is named; undefined without it. */
export function values(fields: FieldArray[], name: string, names: Names, room: (count: number) => Float32Array): Float32Array | undefined {
  const field = fields.find((one) => one.field === name);
  if (field?.width === 1) return field.data instanceof Float32Array ? field.data : Float32Array.from(field.data);
  if (field && field.width !== 3) return sizes(field);
  const velocity = field ?? (name === "speed" ? fields.find((one) => one.field === names.velocity && one.width === 3) : undefined);
  if (!velocity) return undefined;
  const { count, data } = velocity;
  const out = room(count);
  for (let k = 0; k < count; ++k) {
    const x = data[3 * k]!, y = data[3 * k + 1]!, z = data[3 * k + 2]!;
    out[k] = Math.sqrt(x * x + y * y + z * z);
  }
  return out;
}
