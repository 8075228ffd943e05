// Other pages of this browser, and which sessions they show: a session that another one shows is neither paused nor ended when
// this page leaves it. Viewers elsewhere are not known here; for those the service keeps a session for a while.
interface Message {
  page: string;
  /** Undefined: none any more. */
  session?: string | undefined;
  /** Others are asked to answer. */
  ask?: boolean;
}

const kAnswer = 600; // ms that another page has to answer, in the middle of a picture perhaps

export class Neighbours {
  private readonly channel = new BroadcastChannel("truestep-sessions");
  private readonly page = Math.random().toString(36).slice(2);
  private readonly others = new Map<string, string>();
  private session: string | undefined;

  constructor() {
    this.channel.onmessage = ({ data }: MessageEvent<Message>) => {
      if (data.session === undefined) this.others.delete(data.page);
      else this.others.set(data.page, data.session);
      if (data.ask) this.say({ session: this.session });
    };
  }

  /** This page shows `session` from now on; undefined when it is being left. */
  show(session: string | undefined): void {
    this.session = session;
    this.say({ session, ask: session !== undefined });
  }

  /** Whether another page shows this session, too. */
  share(session: string): boolean {
    return [...this.others.values()].includes(session);
  }

  /** Asks whether another page shows this session; this one shows none yet. */
  async taken(session: string): Promise<boolean> {
    this.say({ session: undefined, ask: true });
    for (const end = Date.now() + kAnswer; Date.now() < end && !this.share(session); ) await new Promise((resolve) => setTimeout(resolve, 20));
    return this.share(session);
  }

  private say(message: Omit<Message, "page">): void {
    this.channel.postMessage({ page: this.page, ...message });
  }
}
