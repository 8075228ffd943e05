// The list of speeds beside the play button.
import { byId, make } from "./dom";
import { speedsFor, speedText } from "./speeds";

export class SpeedChoice {
  private readonly list = byId<HTMLSelectElement>("speed");
  private speeds = speedsFor(undefined);
  /** Playing is slower than requested, and the hint has said so. */
  private late = false;

  onChange(handler: () => void): void {
    this.list.addEventListener("change", handler);
  }

  /** Offers the speeds that suit a time step, and `wanted`, which becomes the choice. */
  offer(dt: number | undefined, wanted: number): void {
    this.speeds = speedsFor(dt);
    if (!this.speeds.includes(wanted)) this.speeds = [...this.speeds, wanted].sort((a, b) => a - b);
    this.list.replaceChildren(...this.speeds.map((value) => make("option", { value: String(value), selected: value === wanted }, speedText(value))));
  }

  get value(): number {
    return Number(this.list.value);
  }

  /** Chooses the next speed up or down and says which. */
  next(by: 1 | -1): string {
    const next = Math.min(this.speeds.length - 1, Math.max(0, this.list.selectedIndex + by));
    this.list.selectedIndex = next;
    this.list.dispatchEvent(new Event("change"));
    return `speed ${speedText(this.speeds[next]!)}`;
  }

  /** Shows the requested and achieved speed of a playing session; returns a hint when it starts to fall behind. */
  playing(speed: number, achieved: number, dt: number | undefined): string | undefined {
    if (!this.speeds.includes(speed)) this.offer(dt, speed);
    this.list.value = String(speed);
    const late = achieved > 0 && achieved < 0.9 * speed;
    const comesTo = speedText(Number(achieved.toPrecision(2)));
    this.list.title = late ? `The service is at its limit: it reaches ${comesTo}` : "";
    const hint = late && !this.late ? `the service is at its limit: ${comesTo}` : undefined;
    this.late = late;
    return hint;
  }
}
