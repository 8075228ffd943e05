// A JSON pointer finds its value in the text.
import assert from "node:assert/strict";
import { test } from "node:test";
import { locate } from "../build/client.mjs";

const text = `{
  "name": "a \\"quoted\\" name",
  "systems": [
    {"type": "rope", "n": 12},
    {"type": "cloth", "a/b": {"m~n": [1, 2, 3]}, "c~1d": true}
  ]
}`;
const at = (pointer) => {
  const range = locate(text, pointer);
  return range && text.slice(range.start, range.end);
};

test("members, elements and escaped names are found", () => {
  assert.equal(at("/name"), '"name": "a \\"quoted\\" name"');
  assert.equal(at("/systems/0/n"), '"n": 12');
  assert.equal(at("/systems/1/type"), '"type": "cloth"');
  assert.equal(at("/systems/1/a~1b/m~0n/2"), "3");
  assert.equal(at("/systems/1/c~01d"), '"c~1d": true');
  assert.equal(at(""), text);
});

test("a pointer to what is missing gives the deepest parent", () => {
  assert.equal(at("/systems/0/stiffness"), '{"type": "rope", "n": 12}');
  assert.equal(at("/nothing"), text);
});

test("text that breaks off still finds what stands before the break", () => {
  assert.deepEqual(locate('{"a": 1, "b": [1, ', "/a"), { start: 1, end: 7 });
  assert.equal(locate("", "/a"), undefined);
});
