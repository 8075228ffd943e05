// Frames as typed arrays. A block's bytes are one little-endian array, so F32, F64 and U32 are read as a
// view without a loop; the copy that an unaligned view needs is a memcpy. Q16 is offset + scale * element
// per component, Q16_DELTA the same with elements as differences to the frame that came before.
import { Encoding, type Block, type Frame } from "./gen/truestep/v1/stream_pb";
import { addDifferences, unpackQuaternions } from "./unpack";

/** One field of one system: `count` rows of `width` numbers. */
export interface FieldArray {
  system: string;
  field: string;
  count: number;
  width: number;
  data: Float32Array | Float64Array | Uint32Array | Int32Array;
  /** Largest rounding step of the numbers; 0 if they were sent unrounded. */
  quantum: number;
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
  if (bytes.byteLength % size !== 0) throw new RangeError(`${bytes.byteLength} bytes are not an array of ${size}-byte elements`);
  const aligned = bytes.byteOffset % size === 0 ? bytes : bytes.slice();
  return new Type(aligned.buffer, aligned.byteOffset, aligned.byteLength / size);
}

/** Topology's index arrays. */
export const uints = (bytes: Uint8Array): Uint32Array => view(bytes, Uint32Array);

/** Topology's and marks' arrays of numbers. */
export const floats = (bytes: Uint8Array): Float32Array => view(bytes, Float32Array);

function scaled(block: Block, raw: Uint16Array): Float32Array {
  const out = new Float32Array(raw.length);
  const width = block.width;
  if (width === 3) {
    // The usual case without a stride.
    const [ox = 0, oy = 0, oz = 0] = block.offset;
    const [sx = 1, sy = 1, sz = 1] = block.scale;
    for (let k = 0; k + 2 < raw.length; k += 3) {
      out[k] = ox + sx * raw[k]!;
      out[k + 1] = oy + sy * raw[k + 1]!;
      out[k + 2] = oz + sz * raw[k + 2]!;
    }
    return out;
  }
  for (let c = 0; c < width; ++c) {
    const offset = block.offset[c] ?? 0;
    const scale = block.scale[c] ?? 1;
    for (let k = c; k < raw.length; k += width) out[k] = offset + scale * raw[k]!;
  }
  return out;
}

/** A frame refers to one that this decoder does not hold: a key frame puts it right. */
export class MissingBase extends Error {}

/** Reads the frames of one connection in the order in which they came. */
export class Decoder {
  /** The 16-bit elements that the next differences refer to, by system and field. */
  private readonly held = new Map<string, Uint16Array>();
  private seq = 0n;

  /** All blocks of a frame; 64-bit counters become numbers, exact up to 2^53. */
  frame(frame: Frame, arrived: number, bytes: number): DecodedFrame {
    if (frame.baseSeq !== 0n && frame.baseSeq !== this.seq) throw new MissingBase(`frame ${frame.seq} refers to frame ${frame.baseSeq}, but ${this.seq} is held`);
    const fields = frame.blocks.map((block) => this.block(block));
    this.seq = frame.seq;
    return {
      seq: Number(frame.seq),
      step: Number(frame.step),
      time: frame.time,
      dropped: Number(frame.dropped),
      topologyVersion: frame.topologyVersion,
      fields,
      bytes,
      arrived,
    };
  }

  /** One block; throws RangeError when its bytes do not hold count x width elements. */
  block(block: Block): FieldArray {
    const width = block.width || 1;
    const length = block.count * width;
    const data = this.values(block, length);
    if (data.length !== length) {
      throw new RangeError(`${block.system}.${block.field}: ${data.length} numbers for ${block.count} rows of ${width}`);
    }
    return { system: block.system, field: block.field, count: block.count, width, data, quantum: Math.max(0, ...block.scale) };
  }

  private values(block: Block, length: number): FieldArray["data"] {
    switch (block.encoding) {
      case Encoding.F32:
        return view(block.data, Float32Array);
      case Encoding.F64:
        return view(block.data, Float64Array);
      case Encoding.U32:
        return view(block.data, Uint32Array);
      case Encoding.I32:
        return view(block.data, Int32Array);
      case Encoding.U64:
        // Ids count from 0: every one that occurs is exact as a number.
        return Float64Array.from(view(block.data, BigUint64Array), Number);
      case Encoding.QUAT32:
        return unpackQuaternions(view(block.data, Uint32Array));
      case Encoding.Q16: {
        const raw = view(block.data, Uint16Array);
        this.held.set(`${block.system} ${block.field}`, raw);
        return scaled(block, raw);
      }
      case Encoding.Q16_DELTA: {
        // A group of 256 elements takes at least one byte: a greater length contradicts these bytes.
        if (length > 256 * block.data.length) throw new RangeError(`${block.system}.${block.field}: ${block.data.length} bytes for ${length} differences`);
        const raw = this.base(`${block.system} ${block.field}`, length);
        addDifferences(block.data, raw);
        return scaled(block, raw);
      }
      default:
        throw new RangeError(`${block.system}.${block.field}: unknown encoding ${String(block.encoding)}`);
    }
  }

  /** The elements to add to: rows that were not there count as 0. A key frame's belong to its message and are copied. */
  private base(name: string, length: number): Uint16Array {
    const held = this.held.get(name);
    if (held && held.length === length && held.byteLength === held.buffer.byteLength) return held;
    const own = new Uint16Array(length);
    if (held) own.set(held.subarray(0, length));
    this.held.set(name, own);
    return own;
  }
}

/** A block that stands for itself: any encoding but Q16_DELTA. */
export const decodeBlock = (block: Block): FieldArray => new Decoder().block(block);
