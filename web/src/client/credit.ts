// How many frames may be on their way. The consumer's next turn gives credit for all that arrived; where frames arrive only to
// be replaced, one is held back, so that the next arrives just in time, and given again when none is replaced any more.
const kCalm = 120; // turns of the consumer before one more frame may be in flight
const kLeast = 2; // the frame in use, and the next one on its way

export class Credit {
  private owed = 0;
  /** Frames that may be in flight now, and turns of the consumer since that changed. */
  private window = 0;
  private calm = 0;

  constructor(readonly most: number) {}

  /** A new connection owes nothing. */
  forget(): void {
    this.owed = 0;
  }

  /** The server has been given `most` anew. */
  granted(): void {
    this.window = this.most;
    this.calm = 0;
  }

  arrived(): void {
    ++this.owed;
  }

  /** What the consumer's next turn gives back. */
  take(): number {
    let frames = this.owed;
    if (frames === 0) return 0;
    this.owed = 0;
    ++this.calm;
    if (frames > 1 && this.window > kLeast) {
      --this.window;
      --frames;
      this.calm = 0;
    } else if (this.calm >= kCalm && this.window < this.most) {
      ++this.window;
      ++frames;
      this.calm = 0;
    }
    return frames;
  }
}
