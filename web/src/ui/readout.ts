// The figures beside the picture. Text changes five times a second, so that it can be read.
import type { DecodedFrame } from "../client/decode";
import { byId } from "./dom";
import { timeText } from "./time_text";

const kEvery = 200; // ms between two updates of the text

export class Readout {
  private readonly time = byId("read-time");
  private readonly step = byId("read-step");
  private readonly frame = byId("read-frame");
  private readonly fps = byId("read-fps");
  private readonly dropped = byId("read-dropped");
  private readonly latency = byId("read-latency");
  private pictures = 0;
  private since = performance.now();
  private age = 0;
  private trip = 0;
  /** s; of the whole run, if it is known. */
  duration: number | undefined;
  private newest: DecodedFrame | undefined;
  private droppedHere = 0;

  constructor() {
    setInterval(() => this.write(), kEvery);
  }

  clear(): void {
    this.newest = undefined;
    this.droppedHere = 0;
    this.age = 0;
    this.set(0, 0, 0, 0);
    this.fps.textContent = "0 /s";
  }

  /** Half the round trip of the smallest request approximates a frame's transit time. */
  roundTrip(milliseconds: number): void {
    this.trip = this.trip === 0 ? milliseconds : Math.min(milliseconds, 0.7 * this.trip + 0.3 * milliseconds);
  }

  /** Call when a frame is on the screen. */
  shown(frame: DecodedFrame, superseded: number): void {
    ++this.pictures;
    this.age = 0.9 * this.age + 0.1 * (performance.now() - frame.arrived);
    this.newest = frame;
    this.droppedHere = superseded;
  }

  private write(): void {
    const now = performance.now();
    const elapsed = now - this.since;
    if (elapsed >= 1000) {
      this.fps.textContent = `${Math.round((1000 * this.pictures) / elapsed)} /s`;
      this.pictures = 0;
      this.since = now;
    }
    if (!this.newest) return;
    this.set(this.newest.time, this.newest.step, this.newest.seq, this.newest.dropped + this.droppedHere);
    this.latency.textContent = `${(this.age + this.trip / 2).toFixed(this.age + this.trip / 2 < 10 ? 1 : 0)} ms`;
  }

  private set(time: number, step: number, seq: number, dropped: number): void {
    this.time.textContent = timeText(time, this.duration);
    this.step.textContent = group(step);
    this.frame.textContent = group(seq);
    this.dropped.textContent = group(dropped);
  }
}

/** Groups thousands with a narrow space. */
const group = (value: number): string => String(value).replace(/\B(?=(\d{3})+$)/g, "\u202f");
