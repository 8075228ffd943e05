// The bar of a run's time above the controls: where it is, and, dragged, where it goes. The service goes back exactly, from
// the nearest state that it keeps; ahead, it computes the steps up to there.
import { byId } from "./dom";
import { timeText } from "./time_text";

const kParts = 1000;

export class Timeline {
  private readonly bar = byId<HTMLInputElement>("seek");
  private duration: number | undefined;
  private dt = 0;
  private time = 0;
  /** s; the latest time of this run that has been on the screen. */
  private latest = 0;
  private held = false;

  /** `seek` is asked to go to a time, `say` shows where a dragged bar would go. */
  constructor(seek: (time: number) => void, say: (text: string) => void) {
    this.bar.max = String(kParts);
    this.bar.addEventListener("input", () => {
      this.held = true;
      say(`to ${timeText(this.wanted(), this.duration)}`);
    });
    this.bar.addEventListener("change", () => {
      const time = this.wanted();
      this.held = false;
      this.bar.blur();
      seek(time);
    });
  }

  /** A new run; without a duration the bar ends at the latest time. */
  offer(duration: number | undefined, dt: number | undefined): void {
    Object.assign(this, { duration, dt: dt ?? 0, time: 0, latest: 0, held: false });
    this.write();
  }

  /** A frame of this time is on the screen. */
  shown(time: number): void {
    this.time = time;
    this.latest = Math.max(this.latest, time);
    if (!this.held) this.write();
  }

  private get end(): number {
    return Math.max(this.duration ?? 0, this.latest);
  }

  /** The time under the handle, a multiple of the step. */
  private wanted(): number {
    const time = (Number(this.bar.value) / kParts) * this.end;
    return this.dt > 0 ? Math.round(time / this.dt) * this.dt : time;
  }

  private write(): void {
    const share = this.end > 0 ? this.time / this.end : 0;
    this.bar.value = String(Math.round(kParts * share));
    this.bar.style.setProperty("--share", `${(100 * share).toFixed(1)}%`);
    this.bar.setAttribute("aria-valuetext", timeText(this.time, this.duration));
  }
}
