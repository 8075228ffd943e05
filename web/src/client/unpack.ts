// The packed arrays of a frame: differences of 16-bit values and rotations in 32 bits, as laid down in
// proto/truestep/v1/stream.proto. Pure functions of bytes; RangeError for bytes that make no sense.

const kLanes = 16;
const kGroup = 256;

/**
 * Adds the packed differences in `bytes` to `values` (mod 2^16). One width byte per group of 256 values, zeros up
 * to a multiple of 4, then per group 16 lanes side by side of b-bit entries, lowest bit first, zigzag coded.
 */
export function addDifferences(bytes: Uint8Array, values: Uint16Array): void {
  const groups = Math.ceil(values.length / kGroup);
  const head = (groups + 3) & ~3;
  if (bytes.byteLength < head || bytes.byteLength % 2 !== 0) throw new RangeError(`${bytes.byteLength} bytes are too few for ${values.length} differences`);
  const aligned = bytes.byteOffset % 2 === 0 ? bytes : bytes.slice();
  const words = new Uint16Array(aligned.buffer, aligned.byteOffset, aligned.byteLength / 2);
  let at = head / 2;
  for (let g = 0; g < groups; ++g) {
    const bits = bytes[g]!;
    const first = g * kGroup;
    const count = Math.min(kGroup, values.length - first);
    const entries = Math.ceil(count / kLanes);
    const size = kLanes * Math.ceil((bits * entries) / 16);
    if (bits > 16 || at + size > words.length) throw new RangeError(`group ${g} of ${bits} bits reaches beyond the ${bytes.byteLength} bytes`);
    const mask = (1 << bits) - 1;
    for (let j = 0; bits > 0 && j < entries; ++j) {
      const shift = (j * bits) & 15;
      const word = at + kLanes * ((j * bits) >> 4);
      const spills = shift + bits > 16;
      const lanes = Math.min(kLanes, count - kLanes * j);
      const to = first + kLanes * j;
      for (let l = 0; l < lanes; ++l) {
        let z = words[word + l]! >> shift;
        if (spills) z |= words[word + kLanes + l]! << (16 - shift);
        z &= mask;
        values[to + l]! += (z >> 1) ^ -(z & 1);
      }
    }
    at += size;
  }
  if (at !== words.length) throw new RangeError(`${2 * (words.length - at)} bytes left over after ${groups} groups`);
}

const kQuantum = 1 / (511 * Math.SQRT2);

/** Unit quaternions w x y z from 32 bits each; the rotation is within 4.8e-3 rad of the one that was packed. */
export function unpackQuaternions(packed: Uint32Array): Float32Array {
  const out = new Float32Array(4 * packed.length);
  for (let k = 0; k < packed.length; ++k) {
    const bits = packed[k]!;
    const largest = bits >>> 30;
    const a = (((bits >>> 20) & 1023) - 511) * kQuantum;
    const b = (((bits >>> 10) & 1023) - 511) * kQuantum;
    const c = ((bits & 1023) - 511) * kQuantum;
    const at = 4 * k;
    out[at + (largest === 0 ? 1 : 0)] = a;
    out[at + (largest <= 1 ? 2 : 1)] = b;
    out[at + (largest <= 2 ? 3 : 2)] = c;
    out[at + largest] = Math.sqrt(Math.max(0, 1 - a * a - b * b - c * c));
  }
  return out;
}
