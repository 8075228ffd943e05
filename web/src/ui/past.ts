// Earlier samples of a plot, from the service: at the start, and where frames are missing.
import type { History } from "../client/rest";

const kHistory = 1500; // points of a plot's past
const kPause = 1500; // ms between two requests

export class Past {
  private busy = false;
  private again: (() => void) | undefined;

  constructor(
    private readonly history: (id: string, points: number) => Promise<History>,
    private readonly pause = kPause,
  ) {}

  /** Requests the past of the session `id`; the last of those that come too soon waits for its turn. */
  request(id: string, take: (history: History) => void): void {
    if (this.busy) {
      this.again = () => this.request(id, take);
      return;
    }
    this.busy = true;
    const done = (): void => {
      this.busy = false;
      const again = this.again;
      this.again = undefined;
      again?.();
    };
    this.history(id, kHistory)
      .then(take, () => undefined)
      .finally(() => setTimeout(done, this.pause));
  }

  /** Drops the request that waits: the page leaves its session, which may be gone by then. */
  forget(): void {
    this.again = undefined;
  }
}
