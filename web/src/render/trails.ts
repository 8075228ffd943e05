// Where points have been, as the scene's `trail` asks: lines that fade, of systems with up to 64 points. As in the
// service's pictures (engine/sinks/picture/draw/trails).
import { Color, Group, type IUniform } from "three";
import { WideLines } from "./lines";
import { scenery } from "./shading";

const kMostRows = 64;
const kSamples = 200; // of a trail
const kLeast = 0.15; // how much of its colour the oldest piece has
const kMost = 0.8;

interface Past {
  times: number[];
  places: Float32Array[];
  lines: WideLines;
}

export class Trails {
  readonly object = new Group();
  private readonly pasts = new Map<string, Past>();
  private seconds = 0;

  constructor(private readonly viewHeight: IUniform<number>) {}

  /** Forgets all of them; from now on they are `seconds` of the run long, 0 for none. */
  clear(seconds: number): void {
    for (const { lines } of this.pasts.values()) lines.dispose();
    this.pasts.clear();
    this.seconds = seconds;
  }

  /** Takes the positions of a system's rows at a time of the run. */
  take(id: string, positions: Float32Array, count: number, time: number, color: Color | undefined): void {
    if (this.seconds <= 0 || count === 0 || count > kMostRows) return;
    let past = this.pasts.get(id);
    if (!past) {
      past = { times: [], places: [], lines: new WideLines(this.viewHeight, { pixels: 2, radius: 0, opacity: 1, tube: false }) };
      this.pasts.set(id, past);
      this.object.add(past.lines.object);
    }
    const { times, places } = past;
    // A row that comes or goes leaves no telling which is which; going back in time takes back what was later.
    if (places.length > 0 && places[0]!.length !== 3 * count) times.length = places.length = 0;
    while (times.length > 0 && times[times.length - 1]! >= time) times.pop(), places.pop();
    // What is too near the sample before it is replaced by the newest.
    const n = times.length;
    if (n > 1 && times[n - 1]! - times[n - 2]! < this.seconds / kSamples) times.pop(), places.pop();
    times.push(time), places.push(positions.slice(0, 3 * count));
    while (times[0]! < time - this.seconds) times.shift(), places.shift();
    this.draw(past, count, color ?? scenery.ink);
  }

  private draw({ places, lines }: Past, count: number, color: Color): void {
    const pieces = places.length - 1;
    const ends = new Float32Array(6 * pieces * count);
    lines.reserve(pieces * count);
    for (let k = 0; k < pieces; ++k) {
      const faded = scenery.background.clone().lerp(color, kLeast + ((kMost - kLeast) * (k + 1)) / pieces);
      for (let row = 0; row < count; ++row) {
        const at = k * count + row;
        ends.set(places[k]!.subarray(3 * row, 3 * row + 3), 6 * at);
        ends.set(places[k + 1]!.subarray(3 * row, 3 * row + 3), 6 * at + 3);
        lines.color(at, faded);
      }
    }
    lines.set(ends);
  }
}
