// Blocks as typed arrays: views where aligned, right values where not, refusals by name.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { create, decodeBlock, Decoder, fromBinary, messages, MissingBase, toBinary, unpackQuaternions } from "../build/client.mjs";

const { BlockSchema, Encoding } = messages;
const block = (fields) => create(BlockSchema, { system: "a", field: "position", width: 3, ...fields });

/** The bytes of `array` at `shift` bytes into a larger buffer. */
function at(shift, array) {
  const buffer = new ArrayBuffer(array.byteLength + shift + 8);
  const bytes = new Uint8Array(buffer, shift, array.byteLength);
  bytes.set(new Uint8Array(array.buffer));
  return bytes;
}

const numbers = [1.5, -2, 3.25, 4, 5, 6e-3];

test("an aligned F32 block is a view of the message, not a copy", () => {
  const data = at(8, Float32Array.from(numbers));
  const { data: array, count } = decodeBlock(block({ encoding: Encoding.F32, count: 2, data }));
  assert.equal(count, 2);
  assert.equal(array.buffer, data.buffer);
  assert.deepEqual([...array], [...Float32Array.from(numbers)]);
});

for (const shift of [1, 2, 3, 5]) {
  test(`a block ${shift} bytes off alignment holds the same numbers`, () => {
    const f32 = decodeBlock(block({ encoding: Encoding.F32, count: 2, data: at(shift, Float32Array.from(numbers)) }));
    const f64 = decodeBlock(block({ encoding: Encoding.F64, count: 2, data: at(shift, Float64Array.from(numbers)) }));
    assert.deepEqual([...f32.data], [...Float32Array.from(numbers)]);
    assert.deepEqual([...f64.data], numbers);
  });
}

test("Q16 is offset + scale * element, per component", () => {
  const data = at(0, Uint16Array.from([0, 1, 65535, 10, 20, 30]));
  const { data: array } = decodeBlock(block({ encoding: Encoding.Q16, count: 2, data, offset: [1, 2, 3], scale: [0.5, 1, 2] }));
  assert.deepEqual([...array], [1, 3, 131073, 6, 22, 63]);
});

test("a block with too few or torn bytes is refused", () => {
  assert.throws(() => decodeBlock(block({ encoding: Encoding.F32, count: 3, data: at(0, Float32Array.from(numbers)) })), RangeError);
  assert.throws(() => decodeBlock(block({ encoding: Encoding.F32, count: 1, data: new Uint8Array(11) })), RangeError);
  assert.throws(() => decodeBlock(block({ encoding: Encoding.QUAT32, count: 1, width: 1, data: new Uint8Array(4) })), RangeError);
  assert.throws(() => decodeBlock(block({ encoding: 77, count: 1, width: 1, data: new Uint8Array(4) })), /77/);
});

test("an empty block is an empty array", () => {
  assert.equal(decodeBlock(block({ encoding: Encoding.F32, count: 0, data: new Uint8Array(0) })).data.length, 0);
});

// Two frames of the service's own encoder (tests/unit/streams/stream_blocks_test.cc, the test of the same name).
const golden = readFileSync(new URL("stream_bytes.txt", import.meta.url), "utf8").trim().split("\n").map((hex) => fromBinary(messages.FrameSchema, Uint8Array.from(Buffer.from(hex, "hex"))));
const first = Array.from({ length: 120 }, (_, k) => ((k * 7) % 32) / 32);
const truth = [first, first.map((x, k) => x + ((k % 5) - 2) / 1024)];

/** Largest error of a field in quanta. */
const inQuanta = (array, block, values) => Math.max(...values.map((value, k) => Math.abs(array[k] - value) / block.scale[k % 3]));

test("bytes that the browser reads", () => {
  const decoder = new Decoder();
  golden.forEach((frame, n) => {
    const [x, q] = decoder.frame(frame, 0, 0).fields;
    assert.equal(x.count, truth[n].length / 3);
    // Half a quantum, and what a float of 1 rounds (2^-24) in quanta of 1.25 / 65535.
    assert.ok(inQuanta(x.data, frame.blocks[0], truth[n]) < 0.5 + 0.004);
    const norm = Math.hypot(0.5, -0.5, 0.1, 0.7);
    [0.5, -0.5, 0.1, 0.7].forEach((v, c) => assert.ok(Math.abs(q.data[c] - v / norm) < 0.003));
  });
  assert.equal(golden[1].blocks[0].encoding, Encoding.Q16_DELTA);
  // The control: the second frame's differences on a base of zeros are somewhere else.
  const wrong = new Decoder().block(golden[1].blocks[0]);
  assert.ok(inQuanta(wrong.data, golden[1].blocks[0], truth[1]) > 1000);
});

test("a frame whose base never came asks for a key frame, and later frames are right again", () => {
  const decoder = new Decoder();
  assert.throws(() => decoder.frame(golden[1], 0, 0), MissingBase);
  decoder.frame(golden[0], 0, 0);
  assert.ok(inQuanta(decoder.frame(golden[1], 0, 0).fields[0].data, golden[1].blocks[0], truth[1]) < 0.51);
});

test("the message of a key frame is not written to", () => {
  const decoder = new Decoder();
  const before = [...golden[0].blocks[0].data];
  decoder.frame(golden[0], 0, 0);
  decoder.frame(golden[1], 0, 0);
  assert.deepEqual([...golden[0].blocks[0].data], before);
});

/** Numbers that look random and are the same every time (xorshift32). */
function numbersFrom(seed) {
  let x = seed;
  return () => ((x ^= x << 13), (x ^= x >>> 17), (x ^= x << 5), x >>> 0);
}

test("rotations have length 1 whatever the bits are", () => {
  const next = numbersFrom(9);
  const packed = Uint32Array.from({ length: 2000 }, next).map((bits) => (bits % 2 ? bits : bits & 0xc3f0fc3f));
  const q = unpackQuaternions(packed);
  for (let k = 0; k < packed.length; ++k) {
    const part = q.subarray(4 * k, 4 * k + 4);
    assert.ok(part.every(Number.isFinite));
    assert.ok(Math.hypot(...part) >= 1 - 1e-6);
  }
});

test("torn and altered frames give a frame or an error of their own, never another", () => {
  const next = numbersFrom(77);
  const whole = golden.map((frame) => toBinary(messages.FrameSchema, frame));
  let refused = 0;
  for (let n = 0; n < 4000; ++n) {
    const decoder = new Decoder();
    decoder.frame(golden[0], 0, 0);
    const bytes = whole[1].slice(0, n % 3 === 0 ? next() % whole[1].length : undefined);
    for (let k = next() % 4; k > 0 && bytes.length > 0; --k) bytes[next() % bytes.length] = next();
    let frame;
    try {
      frame = fromBinary(messages.FrameSchema, bytes);
    } catch {
      continue; // no message at all
    }
    if (frame.blocks.some((b) => b.count * b.width > 1e7)) continue;
    try {
      for (const field of decoder.frame(frame, 0, 0).fields) assert.equal(field.data.length, field.count * field.width);
    } catch (error) {
      assert.ok(error instanceof RangeError || error instanceof MissingBase, String(error?.stack));
      ++refused;
    }
  }
  assert.ok(refused > 20, `${refused} refused`);
});
