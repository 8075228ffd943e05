// One button begins a recording of the run on the screen and ends it; what was recorded is then saved as a file.
import type { Service, Session } from "../client/rest";
import { byId } from "./dom";

export class Recorder {
  private id: string | undefined;
  private on = false;

  constructor(
    private readonly service: Service,
    private readonly attempt: (action: () => Promise<void>) => Promise<void>,
    private readonly say: (text: string) => void,
  ) {
    byId("record").addEventListener("click", () => void this.attempt(() => this.turn()));
  }

  /** The session on the screen. */
  show(session: Session): void {
    this.id = session.id;
    this.set(session.recorded === true);
  }

  /** Something has happened to a recording: the session knows what. */
  async look(): Promise<void> {
    const { id } = this;
    if (id === undefined) return;
    const session = await this.service.session(id);
    if (this.id === id) this.show(session);
  }

  private async turn(): Promise<void> {
    const { id } = this;
    if (id === undefined) return;
    if (!this.on) {
      await this.service.startRecording(id);
      this.set(true);
      return this.say("recording: press again to end it and to save it as a file");
    }
    const { frames, recording } = await this.service.endRecording(id);
    this.set(false);
    this.say(`${frames} frames recorded`);
    const link = document.createElement("a");
    link.href = recording;
    link.download = "";
    link.click();
  }

  private set(on: boolean): void {
    this.on = on;
    const button = byId("record");
    button.setAttribute("aria-pressed", String(on));
    button.title = on ? "End the recording and save it as a file" : "Record this run";
  }
}
