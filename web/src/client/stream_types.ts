// What a stream tells its listeners, and what it can be asked for.
import type { Event as StreamEvent, Hello, Marks, Observables, PlaybackState, Shape, Topology } from "./gen/truestep/v1/stream_pb";
import type { Problem } from "./problem";

export type StreamState = "connecting" | "open" | "waiting" | "closed";

export interface StreamEvents {
  hello: Hello;
  topology: Topology;
  /** Where the shapes are at the step of the frame that frames() gives next, in the order of the topology. */
  shapes: Shape[];
  /** Contacts and joints of that frame, where `marks` asks for them. */
  marks: Marks;
  observables: Observables;
  event: StreamEvent;
  playback: PlaybackState;
  problem: Problem;
  /** What the connection does; `waiting` is the pause before the next attempt. */
  state: StreamState;
}

export interface StreamOptions {
  /** Fields to ask for, given what the server has and how it is drawn; default: position. Asked again when either changes. */
  fields?: (hello: Hello, topology: Topology | undefined) => string[];
  /** Whether contacts and joints are wanted; asked with `fields`. */
  marks?: () => { contacts: boolean; joints: boolean };
  rate?: number;
  credit?: number;
  observables?: boolean;
  /** The WebSocket class; Node before 22 has none of its own. */
  webSocket?: typeof WebSocket;
  /** First and longest pause between attempts, ms. */
  backoff?: { first: number; longest: number };
  /** Asked when a connection fails: a problem that makes further attempts pointless, or undefined. */
  probe?: () => Promise<Problem | undefined>;
}
