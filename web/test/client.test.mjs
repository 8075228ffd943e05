// The stream client against the mock service over a real socket.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import WebSocket from "ws";
import { connect, messages, ProblemError, Service } from "../build/client.mjs";
import { serve } from "./mock_server.mjs";

let mock;
let service;
before(async () => {
  mock = await serve();
  service = new Service(mock.url);
});
after(() => mock.close());

const open = (id, options = {}) =>
  connect(service.streamUrl(id, mock.url), { webSocket: WebSocket, backoff: { first: 20, longest: 100 }, ...options });

async function until(condition, what) {
  const end = Date.now() + 5000;
  while (!condition()) {
    if (Date.now() > end) assert.fail(`timed out: ${what}`);
    await new Promise((resolve) => setTimeout(resolve, 5));
  }
}

test("frames arrive as typed arrays, move, and their steps grow", async () => {
  const { id } = await service.createSession({ gallery: "hanging-cloth" });
  const stream = open(id);
  await service.play(id, 1);
  const steps = [];
  let first;
  let last;
  for await (const frame of stream.frames()) {
    const [position] = frame.fields;
    assert.equal(position.field, "position");
    assert.ok(position.data instanceof Float32Array);
    assert.equal(position.data.length, 3 * 26 * 26);
    first ??= position.data;
    last = position.data;
    steps.push(frame.step);
    if (steps.length === 20) break;
  }
  stream.close();
  assert.ok(steps.every((step, k) => k === 0 || step > steps[k - 1]), steps.join());
  assert.notDeepEqual(first, last);
});

test("a slow consumer gets the newest frame, and credit keeps the rest at the server", async () => {
  const { id } = await service.createSession({ gallery: "bouncing-balls" });
  const stream = open(id, { credit: 2 });
  await service.play(id, 1);
  let dropped = 0;
  let count = 0;
  for await (const frame of stream.frames()) {
    dropped = frame.dropped;
    if (++count === 6) break;
    await new Promise((resolve) => setTimeout(resolve, 120));
  }
  // 5 pauses of 120 ms are some 36 ticks of 1/60 s; a client without credit limits would have received them all.
  assert.ok(dropped > 10, `dropped ${dropped}`);
  assert.ok(stream.received < 20, `received ${stream.received}`);
  stream.close();
});

test("a command moves the point and is answered; a wrong one is refused with its pointer", async () => {
  const { id } = await service.createSession({ gallery: "hanging-cloth" });
  const stream = open(id);
  await service.play(id, 1);
  await until(() => stream.state === "open", "open");
  const reply = await stream.command({ type: "drag", system: "cloth", index: 400, target: [0, 3, 1] });
  assert.equal(typeof reply.step, "bigint");
  await until(() => mock.sessions.get(id).world.positions()[1201] > 2, "the point follows");
  await assert.rejects(stream.command({ type: "shove" }), (error) => {
    assert.ok(error instanceof ProblemError);
    assert.equal(error.problem.code, "unknown_command");
    assert.equal(error.problem.errors[0].pointer, "/type");
    return true;
  });
  stream.close();
});

test("a lost connection comes back and frames go on", async () => {
  const { id } = await service.createSession({ gallery: "bouncing-balls" });
  const stream = open(id);
  const states = [];
  stream.on("state", (state) => states.push(state));
  await service.play(id, 1);
  await until(() => stream.received > 2, "frames");
  for (const client of mock.sessions.get(id).clients) client.socket.terminate();
  await until(() => states.filter((state) => state === "open").length === 2, states.join());
  const before = stream.received;
  const consume = (async () => {
    for await (const frame of stream.frames()) if (frame.step < 0) break;
  })();
  await until(() => stream.received > before + 5, "frames after the reconnect");
  stream.close();
  await consume;
  assert.deepEqual(states.slice(0, 4), ["open", "waiting", "connecting", "open"]);
});

test("a session that does not exist ends the stream with the server's problem", async () => {
  const stream = open("no-such-session");
  await assert.rejects(
    (async () => {
      for await (const frame of stream.frames()) assert.fail(`frame ${frame.step}`);
    })(),
    (error) => error instanceof ProblemError && error.problem.code === "unknown_session" && error.problem.status === 404,
  );
  assert.equal(stream.state, "closed");
});

test("observables, playback and topology reach their handlers", async () => {
  const { id } = await service.createSession({ gallery: "bouncing-balls" });
  const stream = open(id, { observables: true });
  const seen = {};
  for (const kind of ["hello", "topology", "playback", "observables"]) stream.on(kind, (value) => (seen[kind] = value));
  await until(() => stream.state === "open", "open");
  await service.play(id, 0.5);
  await until(() => seen.observables && seen.playback?.playing, "observables");
  assert.equal(seen.hello.api, "truestep.v1");
  assert.equal(seen.playback.speed, 0.5);
  assert.equal(seen.topology.systems[0].pointRadius, 0.14);
  assert.ok(seen.observables.values.some((value) => value.name === "energy.total"));
  stream.close();
});

test("refusals over HTTP carry pointers, and no answer is a problem too", async () => {
  await assert.rejects(service.createSession({ sytsems: [] }), (error) => {
    assert.equal(error.problem.status, 422);
    assert.deepEqual(error.problem.errors.map((issue) => issue.pointer), ["/sytsems", "/systems"]);
    return true;
  });
  await assert.rejects(new Service("http://127.0.0.1:9").gallery(), (error) => error.problem.code === "unreachable");
});

test("messages of the generated code are the ones of stream.proto", () => {
  assert.equal(messages.ServerMessageSchema.typeName, "truestep.v1.ServerMessage");
});
