// Following an operation, by events and without them.
import assert from "node:assert/strict";
import { afterEach, test } from "node:test";
import { ProblemError, Service, watch } from "../build/client.mjs";

const operation = (status, progress) => ({ id: "7", kind: "sweep", status, progress, note: "", links: { events: "/v1/operations/7/events" } });

class FakeSource extends EventTarget {
  static CLOSED = 2;
  static last;
  readyState = 0;
  constructor(url) {
    super();
    this.url = url;
    FakeSource.last = this;
  }
  close() {
    this.readyState = FakeSource.CLOSED;
  }
  say(type, value) {
    this.dispatchEvent(Object.assign(new Event(type), { data: JSON.stringify(value) }));
  }
}

/** A service whose answers to GET /v1/operations/7 are these, one after another. */
const service = (...answers) => new Service("", async () => answers.shift() ?? new Response("{}", { status: 500 }));
const answer = (value) => new Response(JSON.stringify(value), { headers: { "content-type": "application/json" } });

afterEach(() => delete globalThis.EventSource);

test("events are told one by one, and the last one closes the connection", () => {
  globalThis.EventSource = FakeSource;
  const seen = [];
  watch(service(), operation("waiting", 0), { changed: (next) => seen.push(next.status), failed: assert.fail });
  const source = FakeSource.last;
  assert.equal(source.url, "/v1/operations/7/events");
  source.say("progress", operation("running", 0.5));
  assert.equal(source.readyState, 0);
  source.say("end", operation("done", 1));
  assert.deepEqual(seen, ["running", "done"]);
  assert.equal(source.readyState, FakeSource.CLOSED);
  source.say("end", operation("done", 1));
  assert.equal(seen.length, 2, "nothing is told after the end");
});

test("a stopped watch tells nothing more", () => {
  globalThis.EventSource = FakeSource;
  const stop = watch(service(), operation("waiting", 0), { changed: assert.fail, failed: assert.fail });
  stop();
  FakeSource.last.say("progress", operation("running", 0.5));
});

test("where events are refused the operation is asked for until it ends", async () => {
  globalThis.EventSource = FakeSource;
  const seen = [];
  await new Promise((resolve) => {
    watch(service(answer(operation("running", 0.2)), answer(operation("cancelled", 0.4))), operation("waiting", 0), {
      changed: (next) => seen.push(next.status) === 2 && resolve(),
      failed: assert.fail,
    });
    // A connection that broke is the browser's to mend.
    FakeSource.last.dispatchEvent(new Event("error"));
    assert.equal(seen.length, 0);
    FakeSource.last.close();
    FakeSource.last.dispatchEvent(new Event("error"));
  });
  assert.deepEqual(seen, ["running", "cancelled"]);
});

test("an operation that has ended needs no connection", async () => {
  globalThis.EventSource = assert.fail;
  const told = await new Promise((resolve) => void watch(service(), operation("done", 1), { changed: resolve, failed: assert.fail }));
  assert.equal(told.status, "done");
});

test("an operation that is gone is a failure", async () => {
  const gone = new Response(JSON.stringify({ title: "Nothing is here", code: "not_found", status: 404 }), { status: 404, headers: { "content-type": "application/problem+json" } });
  const error = await new Promise((resolve) => void watch(service(gone), operation("running", 0), { changed: assert.fail, failed: resolve }));
  assert.ok(error instanceof ProblemError);
  assert.equal(error.problem.code, "not_found");
});
