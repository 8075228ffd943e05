// The stream of the session on the screen: what each of its messages does to the page.
import type { DecodedFrame } from "../client/decode";
import { partsOf } from "../client/parts";
import { byId } from "./dom";
import { connect, type Stream, type StreamState } from "../client/stream";
import type { Event as StreamEvent, Part, PlaybackState } from "../client/gen/truestep/v1/stream_pb";
import type { Stage } from "../render/stage";
import { Compact } from "./compact";
import { fieldsOf } from "./fields";
import type { Page } from "./page";
import type { Plot } from "./plot";
import { showProblem } from "./problems";
import type { Readout } from "./readout";
import { showScale } from "./scale";

const kMarks = 5000; // pictures that leave a performance mark, for scripts/measure.mjs

/** What the messages are shown by. */
export interface Instruments {
  readonly stage: Stage;
  readonly page: Page;
  readonly plot: Plot;
  readonly readout: Readout;
  /** Which contacts and joints are wanted. */
  readonly marks: { contacts: boolean; joints: boolean };
}

/** What the page learns besides. */
export interface Listener {
  state(state: StreamState): void;
  playback(state: PlaybackState): void;
  event(event: StreamEvent): void;
  /** A frame is on the screen. */
  shown(frame: DecodedFrame): void;
  failed(error: unknown): void;
}

export class Live {
  private readonly compact = new Compact();
  private stream: Stream | undefined;
  private measured = 0;
  /** Whether joints were marked before colours marked them; undefined: colours have not. */
  private markedBefore: boolean | undefined;

  constructor(private readonly on: Instruments) {}

  get state(): StreamState | undefined {
    return this.stream?.state;
  }

  /** Ends the last stream; nothing of it arrives any more. */
  close(): void {
    this.stream?.close();
  }

  /** Sends a command and waits until it is accepted or refused. */
  async command(body: Record<string, unknown>): Promise<void> {
    await this.stream?.command(body);
  }

  post(body: Record<string, unknown>): void {
    this.stream?.post(body);
  }

  resubscribe(): void {
    this.stream?.resubscribe();
  }

  /** Joints are marked where the scene's colours show their values; other scenes find the switch as it was left. */
  private showJoints(parts: Map<string, Part>): void {
    const { stage, marks } = this.on;
    const { bySpeed, colorBy } = stage.show;
    const colored = bySpeed && [...parts.values()].some((part) => part.elements === "joints" && part.fields.some((field) => field.name === colorBy));
    if (colored && !marks.joints) this.markedBefore = marks.joints;
    if (colored) marks.joints = true;
    else if (this.markedBefore !== undefined) marks.joints = this.markedBefore;
    if (!colored) this.markedBefore = undefined;
    byId("show-joints").setAttribute("aria-pressed", String(marks.joints));
  }

  /** Shows the stream at `url` from now on. */
  open(url: string, listener: Listener): void {
    const { stage, page, plot, marks } = this.on;
    const stream = connect(url, { observables: true, credit: 4, fields: (hello, topology) => fieldsOf(stage.show, hello, topology), marks: () => marks });
    this.stream = stream;
    const mine = <T>(handler: (value: T) => void) => (value: T) => {
      if (this.stream === stream) handler(value);
    };
    page.connection("connecting");
    stream.on("state", mine((state) => {
      page.connection(state);
      listener.state(state);
    }));
    stream.on("hello", mine((hello) => {
      const parts = partsOf(hello);
      this.compact.greet(hello);
      stage.setParts(parts);
      this.showJoints(parts);
    }));
    stream.on("topology", mine((topology) => {
      this.compact.connect(topology);
      stage.setTopology(topology);
      page.toggles();
    }));
    stream.on("shapes", mine((shapes) => stage.moveShapes(shapes)));
    stream.on("marks", mine((marked) => stage.setMarks(marked)));
    stream.on("playback", mine((state) => listener.playback(state)));
    stream.on("observables", mine((observables) => plot.add(observables)));
    stream.on("problem", mine((problem) => showProblem(problem)));
    stream.on("event", mine((event) => listener.event(event)));
    void this.consume(stream, listener);
  }

  private async consume(stream: Stream, listener: Listener): Promise<void> {
    try {
      for await (const frame of stream.frames()) {
        if (this.stream !== stream) break;
        stream.encode(this.compact.choose(frame));
        await this.on.stage.present(frame);
        showScale(this.on.stage.colorScale);
        listener.shown(frame);
        if (this.measured++ < kMarks) performance.mark(this.measured === 1 ? "first-picture" : "picture");
        this.on.readout.shown(frame, stream.superseded);
      }
    } catch (error) {
      if (this.stream === stream) listener.failed(error);
    }
  }
}
