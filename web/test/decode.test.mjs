// Blocks as typed arrays: views where aligned, right values where not, refusals by name.
import assert from "node:assert/strict";
import { test } from "node:test";
import { create, decodeBlock, messages } from "../build/client.mjs";

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
  assert.throws(() => decodeBlock(block({ encoding: Encoding.QUAT32, count: 1, width: 1, data: new Uint8Array(4) })), /QUAT32/);
});

test("an empty block is an empty array", () => {
  assert.equal(decodeBlock(block({ encoding: Encoding.F32, count: 0, data: new Uint8Array(0) })).data.length, 0);
});
