// Frames as typed arrays. A block's bytes are one little-endian array, so F32, F64 and U32 are read as a
// view without a loop; the copy that an unaligned view needs is a memcpy. Q16 is offset + scale * element
// per component. Q16_DELTA and QUAT32 are never asked for by this client and are refused by name.
import { Encoding, type Block, type Frame } from "./gen/truestep/v1/stream_pb";

/** One field of one system: `count` rows of `width` numbers. */
export interface FieldArray {
  system: string;
  field: string;
  count: number;
  width: number;
  data: Float32Array | Float64Array | Uint32Array;
}

/** A frame as the viewer uses it. */
export interface DecodedFrame {
  seq: number;
  step: number;
  time: number;
  dropped: number;
  topologyVersion: number;
  fields: FieldArray[];
  bytes: number;
  /** performance.now() when the message arrived. */
  arrived: number;
}

type ArrayType<T> = { new (buffer: ArrayBufferLike, offset: number, length: number): T; BYTES_PER_ELEMENT: number };

/** The bytes as an array of `Type`: a view where they are aligned, a copy where not. */
function view<T>(bytes: Uint8Array, Type: ArrayType<T>): T {
  const size = Type.BYTES_PER_ELEMENT;
  if (bytes.byteLength % size !== 0) throw new RangeError(`${bytes.byteLength} bytes are no array of ${size}-byte elements`);
  const aligned = bytes.byteOffset % size === 0 ? bytes : bytes.slice();
  return new Type(aligned.buffer, aligned.byteOffset, aligned.byteLength / size);
}

/** Topology's index arrays. */
export const uints = (bytes: Uint8Array): Uint32Array => view(bytes, Uint32Array);

function quantised(block: Block): Float32Array {
  const raw = view(block.data, Uint16Array);
  const out = new Float32Array(raw.length);
  const width = block.width;
  for (let c = 0; c < width; ++c) {
    const offset = block.offset[c] ?? 0;
    const scale = block.scale[c] ?? 1;
    for (let k = c; k < raw.length; k += width) out[k] = offset + scale * (raw[k] as number);
  }
  return out;
}

/** One block; throws RangeError when its bytes do not hold count x width elements. */
export function decodeBlock(block: Block): FieldArray {
  let data: FieldArray["data"];
  switch (block.encoding) {
    case Encoding.F32:
      data = view(block.data, Float32Array);
      break;
    case Encoding.F64:
      data = view(block.data, Float64Array);
      break;
    case Encoding.U32:
      data = view(block.data, Uint32Array);
      break;
    case Encoding.Q16:
      data = quantised(block);
      break;
    default:
      throw new RangeError(`${block.system}.${block.field}: encoding ${Encoding[block.encoding]} was not asked for`);
  }
  const width = block.width || 1;
  if (data.length !== block.count * width) {
    throw new RangeError(`${block.system}.${block.field}: ${data.length} numbers for ${block.count} rows of ${width}`);
  }
  return { system: block.system, field: block.field, count: block.count, width, data };
}

/** All blocks of a frame; 64-bit counters become numbers, exact up to 2^53. */
export function decodeFrame(frame: Frame, arrived: number, bytes: number): DecodedFrame {
  return {
    seq: Number(frame.seq),
    step: Number(frame.step),
    time: frame.time,
    dropped: Number(frame.dropped),
    topologyVersion: frame.topologyVersion,
    fields: frame.blocks.map(decodeBlock),
    bytes,
    arrived,
  };
}
