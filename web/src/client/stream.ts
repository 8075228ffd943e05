// The stream of one session, for the browser and for Node.
//
//   const stream = connect(url, {observables: true});
//   stream.on("playback", p => ...);
//   for await (const frame of stream.frames()) draw(frame);
//
// Frames are taken newest first: while the loop's body runs, later frames replace each other, and asking for the next
// frame returns the credit of all that arrived. A slow consumer, or a hidden tab, therefore makes the server drop
// frames, never queue them; if frames arrive only to be replaced, credit is held back until the next one arrives just
// in time, and given again when none is replaced any more. A lost connection is re-established automatically with
// growing, jittered pauses; a session that is gone, or a refused key, ends the stream with the server's problem.
import { create, fromBinary, toBinary, type MessageInitShape } from "@bufbuild/protobuf";
import { Decoder, MissingBase, type DecodedFrame } from "./decode";
import { ProblemError, problemOfResponse, type Problem } from "./problem";
import {
  ClientMessageSchema,
  Encoding,
  Policy,
  ServerMessageSchema,
  type Frame,
  type Hello,
  type Marks,
  type Reply,
  type Shape,
  type Topology,
} from "./gen/truestep/v1/stream_pb";
import { Credit } from "./credit";
import type { StreamEvents, StreamOptions, StreamState } from "./stream_types";

export type { StreamEvents, StreamOptions, StreamState } from "./stream_types";

export const kSubprotocol = "truestep.v1.proto";

type ClientInit = MessageInitShape<typeof ClientMessageSchema>;
type Handlers = { [K in keyof StreamEvents]: Set<(value: StreamEvents[K]) => void> };
interface Pending {
  resolve: (reply: Reply) => void;
  reject: (error: ProblemError) => void;
}

const lost: Problem = { title: "The connection was lost", status: 0, code: "connection_lost" };

export class Stream {
  private readonly handlers: Handlers = {
    hello: new Set(),
    topology: new Set(),
    shapes: new Set(),
    marks: new Set(),
    observables: new Set(),
    event: new Set(),
    playback: new Set(),
    problem: new Set(),
    state: new Set(),
  };
  private readonly pending = new Map<string, Pending>();
  private socket: WebSocket | undefined;
  private current: StreamState = "connecting";
  private attempts = 0;
  private requests = 0;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private decoder = new Decoder();
  private newest: DecodedFrame | undefined;
  /** What belongs to `newest` besides its fields; it inherits the shapes of frames that were replaced. */
  private shapes: Shape[] | undefined;
  private marks: Marks | undefined;
  private wake: (() => void) | undefined;
  private failure: Problem | undefined;
  private greeting: Hello | undefined;
  private topology: Topology | undefined;
  /** What the server was asked for last. */
  private asked = "";
  private encoding = Encoding.F32;
  private readonly credit: Credit;

  /** Frames that arrived and frames that a newer one replaced before they were used. */
  received = 0;
  superseded = 0;

  constructor(
    private readonly url: string,
    private readonly options: StreamOptions,
  ) {
    this.credit = new Credit(options.credit ?? 4);
    this.open();
  }

  get state(): StreamState {
    return this.current;
  }

  /** Calls `handler` for every such message from now on; returns a function that stops it. */
  on<K extends keyof StreamEvents>(kind: K, handler: (value: StreamEvents[K]) => void): () => void {
    this.handlers[kind].add(handler);
    return () => void this.handlers[kind].delete(handler);
  }

  /** The newest frame, again and again, until the stream is closed. Throws ProblemError when it ended in one. */
  async *frames(): AsyncGenerator<DecodedFrame, void, void> {
    for (;;) {
      while (this.newest === undefined && this.current !== "closed") {
        await new Promise<void>((resolve) => (this.wake = resolve));
      }
      if (this.newest === undefined) break;
      const frame = this.newest;
      this.newest = undefined;
      if (this.shapes) this.emit("shapes", this.shapes);
      if (this.marks) this.emit("marks", this.marks);
      this.shapes = this.marks = undefined;
      yield frame;
      this.returnCredit();
    }
    if (this.failure) throw new ProblemError(this.failure);
  }

  /** Sends a command (the body of POST .../commands) and waits until it is accepted or refused. */
  command(body: Record<string, unknown>): Promise<Reply> {
    return this.request({ case: "command", value: { json: JSON.stringify(body) } });
  }

  /** Sends a command without waiting: a refusal arrives as a `problem` event. For drags, many a second. */
  post(body: Record<string, unknown>): void {
    this.send({ kind: { case: "command", value: { json: JSON.stringify(body) } } });
  }

  /** Playback over the stream: play, pause, step, seek, speed, reset. */
  control(action: string, value = 0): Promise<Reply> {
    return this.request({ case: "control", value: { action, value } });
  }

  /** Asks `fields` and `marks` again and tells the server when its answer changed. */
  resubscribe(): void {
    if (this.greeting && JSON.stringify(this.wanted()) !== this.asked) this.subscribe();
  }

  /** How floating-point fields travel from now on, at first F32; Q16_DELTA takes about a third of its bytes. */
  encode(encoding: Encoding): void {
    if (encoding === this.encoding) return;
    this.encoding = encoding;
    if (this.greeting) this.subscribe();
  }

  close(): void {
    this.finish(undefined);
  }

  private request(kind: ClientInit["kind"]): Promise<Reply> {
    const requestId = String(++this.requests);
    return new Promise((resolve, reject) => {
      if (this.socket?.readyState !== 1) return reject(new ProblemError(lost));
      this.pending.set(requestId, { resolve, reject });
      this.send({ requestId, kind });
    });
  }

  private send(message: ClientInit): void {
    if (this.socket?.readyState !== 1) return;
    this.socket.send(toBinary(ClientMessageSchema, create(ClientMessageSchema, message)) as Uint8Array<ArrayBuffer>);
  }

  private returnCredit(): void {
    const frames = this.credit.take();
    if (frames > 0) this.send({ kind: { case: "credit", value: { frames } } });
  }

  private emit<K extends keyof StreamEvents>(kind: K, value: StreamEvents[K]): void {
    for (const handler of this.handlers[kind]) handler(value);
  }

  private become(state: StreamState): void {
    if (state === this.current) return;
    this.current = state;
    this.emit("state", state);
  }

  private open(): void {
    const Socket = this.options.webSocket ?? WebSocket;
    const socket = new Socket(this.url, [kSubprotocol]);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onmessage = (message: MessageEvent) => {
      if (!(message.data instanceof ArrayBuffer)) return;
      try {
        this.receive(message.data);
      } catch (error) {
        const detail = error instanceof Error ? error.message : String(error);
        this.finish({ title: "A message could not be read", status: 0, code: "bad_message", detail });
      }
    };
    socket.onerror = () => undefined; // "close" follows and says more
    socket.onclose = (event: CloseEvent) => void this.closed(socket, event);
  }

  private receive(buffer: ArrayBuffer): void {
    const arrived = performance.now();
    const { kind } = fromBinary(ServerMessageSchema, new Uint8Array(buffer));
    switch (kind.case) {
      case "frame":
        ++this.received;
        this.credit.arrived();
        this.take(kind.value, arrived, buffer.byteLength);
        break;
      case "hello":
        this.attempts = 0;
        this.credit.forget();
        this.greeting = kind.value;
        this.decoder = new Decoder();
        this.topology = undefined;
        this.shapes = this.marks = undefined;
        this.emit("hello", kind.value);
        this.subscribe();
        this.become("open");
        break;
      case "reply":
        this.settle(kind.value.requestId)?.resolve(kind.value);
        break;
      case "problem": {
        const problem: Problem = { ...kind.value, detail: kind.value.detail || undefined };
        if (kind.value.pointer) problem.errors = [{ pointer: kind.value.pointer, code: kind.value.code, message: kind.value.detail }];
        const asked = this.settle(kind.value.requestId);
        if (asked) asked.reject(new ProblemError(problem));
        else this.emit("problem", problem);
        break;
      }
      case "topology":
        this.topology = kind.value;
        this.shapes = undefined;
        this.emit("topology", kind.value);
        this.resubscribe();
        break;
      case "observables":
        this.emit("observables", kind.value);
        break;
      case "event":
        this.emit("event", kind.value);
        break;
      case "playback":
        this.emit("playback", kind.value);
        break;
      case "bye":
        // A server that is shutting down may come back.
        if (kind.value.code === "draining") break;
        this.finish({ title: "The session has ended", status: 0, code: kind.value.code, detail: kind.value.reason });
        break;
      case undefined:
        break;
    }
  }

  private take(frame: Frame, arrived: number, bytes: number): void {
    if (frame.shapes.length > 0) this.shapes = frame.shapes;
    this.marks = frame.marks;
    try {
      const decoded = this.decoder.frame(frame, arrived, bytes);
      if (this.newest) ++this.superseded;
      this.newest = decoded;
      this.wake?.();
    } catch (error) {
      if (!(error instanceof MissingBase)) throw error;
      this.returnCredit();
      this.send({ kind: { case: "requestKeyframe", value: {} } });
    }
  }

  private wanted(): { fields: string[]; contacts: boolean; joints: boolean } {
    const fields = (this.greeting && this.options.fields?.(this.greeting, this.topology)) ?? [];
    return { fields, contacts: false, joints: false, ...this.options.marks?.() };
  }

  private subscribe(): void {
    const wanted = this.wanted();
    this.asked = JSON.stringify(wanted);
    this.credit.granted();
    this.send({
      kind: {
        case: "subscribe",
        value: {
          ...wanted,
          rate: this.options.rate ?? 60,
          encoding: this.encoding,
          policy: Policy.LATEST,
          credit: this.credit.most,
          observables: this.options.observables ?? false,
        },
      },
    });
  }

  private settle(requestId: string): Pending | undefined {
    const pending = this.pending.get(requestId);
    this.pending.delete(requestId);
    return pending;
  }

  private async closed(socket: WebSocket, event: CloseEvent): Promise<void> {
    if (socket !== this.socket || this.current === "closed") return;
    this.socket = undefined;
    for (const { reject } of this.pending.values()) reject(new ProblemError(lost));
    this.pending.clear();
    this.become("waiting");
    if (event.code === 1008 || event.code === 1002 || event.code === 1003) {
      return this.finish({ title: "The server closed the stream", status: 0, code: "stream_refused", detail: event.reason || `close code ${event.code}` });
    }
    const problem = await (this.options.probe ?? (() => this.probe()))();
    if (this.state === "closed") return;
    if (problem) return this.finish(problem);
    const { first, longest } = this.options.backoff ?? { first: 250, longest: 8000 };
    const pause = Math.min(longest, first * 2 ** this.attempts++) * (0.75 + 0.5 * Math.random());
    this.timer = setTimeout(() => {
      this.become("connecting");
      this.open();
    }, pause);
  }

  /** A browser does not say why a handshake failed, so ask over HTTP whether the session still exists. */
  private async probe(): Promise<Problem | undefined> {
    const url = this.url.replace(/^ws/, "http").replace(/\/stream$/, "");
    try {
      const response = await fetch(url);
      return [401, 403, 404, 410].includes(response.status) ? await problemOfResponse(response) : undefined;
    } catch {
      return undefined;
    }
  }

  private finish(failure: Problem | undefined): void {
    if (this.current === "closed") return;
    this.failure = failure;
    clearTimeout(this.timer);
    for (const { reject } of this.pending.values()) reject(new ProblemError(failure ?? lost));
    this.pending.clear();
    const socket = this.socket;
    this.socket = undefined;
    socket?.close(1000);
    this.become("closed");
    this.wake?.();
  }
}

/** Opens the stream of a session at a ws:// or wss:// address. Failures arrive through frames() and `state`. */
export function connect(url: string, options: StreamOptions = {}): Stream {
  return new Stream(url, options);
}
