// A stand-in for the service: the parts of the HTTP and stream protocol that the viewer uses, with scenes
// computed in JavaScript. Fixture of the client's tests; `npm run mock` serves web/dist with it.
import { createServer } from "node:http";
import { readFile } from "node:fs/promises";
import { randomUUID } from "node:crypto";
import { fileURLToPath } from "node:url";
import path from "node:path";
import { WebSocketServer } from "ws";
import { create, fromBinary, messages, toBinary } from "../build/client.mjs";
import { gallery } from "./mock_scenes.mjs";

const dist = path.join(path.dirname(fileURLToPath(import.meta.url)), "..", "dist");
const mime = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml" };
const dt = 1 / 120;

const problem = (status, code, title, more = {}) => ({ status, body: { type: `/problems/${code}`, title, status, code, ...more } });

/** The scene document that the mock gives out and takes back: strict enough to show errors. */
function check(scene) {
  const errors = [];
  const known = ["name", "gravity", "time", "systems", "viewer", "schema_version"];
  for (const key of Object.keys(scene)) {
    if (!known.includes(key) && !key.startsWith("x_")) {
      const near = known.find((name) => name.slice(0, 3) === key.slice(0, 3));
      errors.push({ pointer: `/${key}`, code: "unknown_key", message: `No scene has a member ${key}.`, value: scene[key], allowed: known, did_you_mean: near });
    }
  }
  for (const [k, system] of (scene.systems ?? []).entries()) {
    if (!gallery.some((entry) => entry.name === system.type)) {
      errors.push({ pointer: `/systems/${k}/type`, code: "unknown_type", value: system.type, allowed: gallery.map((entry) => entry.name) });
    }
  }
  if (!scene.systems?.length) errors.push({ pointer: "/systems", code: "missing", message: "A scene needs at least one system." });
  return errors;
}

const sceneOf = (entry) => ({
  schema_version: "1.0",
  name: entry.title,
  gravity: [0, -9.81, 0],
  time: { dt },
  systems: [{ type: entry.name, id: "a" }],
  viewer: { ...(entry.camera ? { camera: entry.camera } : {}), color_by: "speed" },
});

const describe = ({ id, entry, scene, step }) => ({ id, dt, step, title: entry.title, teaches: entry.teaches, viewer: scene.viewer ?? {} });

class Session {
  constructor(entry, scene) {
    Object.assign(this, { id: randomUUID(), entry, scene, step: 0, playing: false, speed: 1, clients: new Set(), clock: 0 });
    this.world = entry.make();
    this.timer = setInterval(() => this.tick(), 1000 / 60);
  }

  tick() {
    if (!this.playing) return;
    this.clock += this.speed / 60;
    for (let k = 0; this.clock >= dt && k < 8; ++k, this.clock -= dt) this.advance();
    this.publish();
  }

  advance() {
    this.world.step(dt);
    ++this.step;
  }

  reset() {
    this.step = 0;
    this.world.reset();
    this.playing = false;
  }

  playback() {
    return { kind: { case: "playback", value: { playing: this.playing, speed: this.speed, step: BigInt(this.step), time: this.step * dt } } };
  }

  frame(client) {
    const { world } = this;
    const x = world.positions();
    const bytes = (array) => new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
    const block = (field, width, array) => ({ system: world.system, field, encoding: 0, count: x.length / 3, width, data: bytes(array) });
    const blocks = [block("position", 3, x)];
    if (client.fields.includes("velocity")) blocks.push(block("velocity", 3, world.velocities()));
    return {
      kind: {
        case: "frame",
        value: { seq: BigInt(++client.seq), step: BigInt(this.step), time: this.step * dt, dropped: BigInt(client.dropped), topologyVersion: 1, keyframe: true, blocks },
      },
    };
  }

  publish() {
    for (const client of this.clients) {
      if (!client.subscribed) continue;
      if (client.credit > 0) {
        --client.credit;
        client.send(this.frame(client));
      } else {
        ++client.dropped;
        client.stale = true;
      }
      const { kinetic, potential } = this.world.energies();
      const values = [
        { name: "energy.kinetic", value: kinetic, unit: "J" },
        { name: "energy.potential", value: potential, unit: "J" },
        { name: "energy.total", value: kinetic + potential, unit: "J" },
      ];
      if (client.observables) client.send({ kind: { case: "observables", value: { step: BigInt(this.step), time: this.step * dt, values } } });
    }
  }

  tell() {
    for (const client of this.clients) client.send(this.playback());
    this.publish();
  }

  close(code = 1000) {
    clearInterval(this.timer);
    for (const client of this.clients) client.socket.close(code);
  }
}

function attach(session, socket) {
  const client = {
    socket, credit: 0, seq: 0, dropped: 0, fields: [], observables: false, subscribed: false, stale: false,
    send: (message) => socket.send(toBinary(messages.ServerMessageSchema, create(messages.ServerMessageSchema, message))),
  };
  session.clients.add(client);
  socket.on("close", () => session.clients.delete(client));
  const fields = [{ name: "position", unit: "m", width: 3, meaning: "position" }, { name: "velocity", unit: "m/s", width: 3, meaning: "velocity" }];
  const { system } = session.world;
  client.send({
    kind: {
      case: "hello",
      value: { api: "truestep.v1", session: session.id, server: "mock", dt, systems: [{ id: system, type: "mock", fields }], parts: [{ id: system, system, kind: "points", fields }], sceneName: session.entry.title },
    },
  });
  client.send({ kind: { case: "topology", value: { version: 1, ...session.world.topology() } } });
  client.send(session.playback());
  socket.on("message", (data) => {
    const { requestId, kind } = fromBinary(messages.ClientMessageSchema, new Uint8Array(data));
    if (kind.case === "subscribe") {
      Object.assign(client, { subscribed: true, credit: kind.value.credit || 4, fields: kind.value.fields, observables: kind.value.observables });
      session.publish();
    } else if (kind.case === "credit") {
      client.credit += kind.value.frames;
      if (client.stale) {
        client.stale = false;
        --client.credit;
        client.send(session.frame(client));
      }
    } else if (kind.case === "command") {
      const body = JSON.parse(kind.value.json);
      if (!["drag", "release", "pin", "unpin"].includes(body.type)) {
        return client.send({ kind: { case: "problem", value: { code: "unknown_command", title: "Unknown command", detail: `There is no command ${body.type}`, status: 422, requestId, pointer: "/type" } } });
      }
      session.world.command(body);
      if (requestId) client.send({ kind: { case: "reply", value: { requestId, step: BigInt(session.step) } } });
    }
  });
}

/** Serves on `port` (0 picks one); resolves to {url, sessions, close()}. */
export function serve(port = 0) {
  const sessions = new Map();

  function route(method, url, text) {
    const [, , collection, id, action] = url.pathname.split("/");
    if (url.pathname === "/healthz") return { status: 200, body: { status: "ok" } };
    if (collection === "gallery") {
      const entry = gallery.find((e) => e.name === id);
      if (entry) return { status: 200, body: { name: entry.name, title: entry.title, teaches: entry.teaches, scene: sceneOf(entry), expect: [] } };
      if (id) return problem(404, "unknown_scene", "No such scene", { detail: `The gallery has no scene "${id}".` });
      return { status: 200, body: { scenes: gallery.map(({ name, title, teaches, tags }) => ({ name, title, teaches, tags })) } };
    }
    let body;
    try {
      body = text ? JSON.parse(text) : {};
    } catch (error) {
      return problem(400, "malformed_json", "The body is no JSON", { detail: error.message });
    }
    if (collection === "scenes") return { status: 200, body: { errors: check(body), warnings: [] } };
    if (!id && method === "POST") {
      const named = gallery.find((e) => e.name === body.gallery);
      const errors = named ? [] : check(body);
      if (errors.length) return problem(422, "scene_invalid", "The scene has mistakes", { detail: `${errors.length} value(s) need a change.`, errors });
      const entry = named ?? gallery.find((e) => e.name === body.systems[0].type);
      const session = new Session(entry, named ? sceneOf(entry) : body);
      sessions.set(session.id, session);
      const self = `/v1/sessions/${session.id}`;
      return { status: 201, body: { ...describe(session), links: { self, stream: `${self}/stream`, viewer: `/?session=${session.id}` } } };
    }
    const session = sessions.get(id);
    if (!session) return problem(404, "unknown_session", "No such session", { detail: `There is no session ${id}. It may have expired.` });
    if (method === "DELETE") {
      session.close();
      sessions.delete(id);
      return { status: 204 };
    }
    if (action === "play") Object.assign(session, { playing: true, speed: body.speed ?? 1 });
    if (action === "pause") session.playing = false;
    if (action === "reset") session.reset();
    if (action === "step") for (let k = 0; k < body.steps; ++k) session.advance();
    if (action) session.tell();
    return { status: 200, body: { ...describe(session), links: { self: `/v1/sessions/${id}` } } };
  }

  const server = createServer(async (request, response) => {
    const url = new URL(request.url, "http://mock");
    if (url.pathname.startsWith("/v1") || url.pathname === "/healthz") {
      const chunks = [];
      for await (const chunk of request) chunks.push(chunk);
      const { status, body } = route(request.method, url, Buffer.concat(chunks).toString());
      response.writeHead(status, { "content-type": status >= 400 ? "application/problem+json" : "application/json" });
      return response.end(body === undefined ? "" : JSON.stringify(body));
    }
    try {
      const file = path.join(dist, url.pathname === "/" ? "index.html" : path.normalize(url.pathname));
      const data = await readFile(file);
      response.writeHead(200, { "content-type": mime[path.extname(file)] ?? "application/octet-stream" });
      response.end(data);
    } catch {
      response.writeHead(404).end();
    }
  });
  const sockets = new WebSocketServer({ noServer: true, perMessageDeflate: false });
  server.on("upgrade", (request, socket, head) => {
    const session = sessions.get(request.url.split("/")[3]);
    if (!session) return socket.end("HTTP/1.1 404 Not Found\r\ncontent-length: 0\r\n\r\n");
    sockets.handleUpgrade(request, socket, head, (ws) => attach(session, ws));
  });
  return new Promise((resolve) =>
    server.listen(port, "127.0.0.1", () =>
      resolve({
        url: `http://127.0.0.1:${server.address().port}`,
        sessions,
        close() {
          for (const session of sessions.values()) session.close(1001);
          for (const ws of sockets.clients) ws.terminate();
          server.closeAllConnections();
          server.close();
        },
      }),
    ),
  );
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const at = process.argv.indexOf("--port");
  const mock = await serve(at > 0 ? Number(process.argv[at + 1]) : 0);
  console.log(`mock service at ${mock.url}`);
}
