// Other pages of this browser, and which sessions they show: a session that another one shows is neither paused nor ended when
// this page leaves it. Viewers elsewhere are not known here; for those the service keeps a session for a while.
interface Message {
  page: string;
  /** Undefined: none any more. */
  session?: string | undefined;
  /** Others are asked to answer. */
  ask?: boolean;
}

const kAnswer = 600; // ms that another page has to answer, in the middle of a picture perhaps, or to let go of its session
const kLock = "truestep-session-";

/** Names of what pages of this browser hold, which the browser itself knows however busy they are; not on insecure addresses. */
async function heldLocks(): Promise<string[] | undefined> {
  if (!("locks" in navigator)) return undefined;
  const { held } = await navigator.locks.query();
  return (held ?? []).map((lock) => lock.name ?? "");
}

export class Neighbours {
  private readonly channel = new BroadcastChannel("truestep-sessions");
  private readonly page = Math.random().toString(36).slice(2);
  private readonly others = new Map<string, string>();
  private session: string | undefined;
  private release: (() => void) | undefined;

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
    this.hold(session);
    this.say({ session, ask: session !== undefined });
  }

  /** Whether another page shows this session, too. */
  share(session: string): boolean {
    return [...this.others.values()].includes(session);
  }

  /** Whether another page shows this session; this one shows none yet. A page that was just left lets go of it meanwhile. */
  async taken(session: string): Promise<boolean> {
    this.say({ session: undefined, ask: true });
    const end = Date.now() + kAnswer;
    while (true) {
      const held = await heldLocks();
      if (held && !held.includes(kLock + session)) return false;
      if (Date.now() >= end) return held !== undefined || this.share(session);
      if (!held && this.share(session)) return true;
      await new Promise((resolve) => setTimeout(resolve, 20));
    }
  }

  private hold(session: string | undefined): void {
    this.release?.();
    const left = new Promise<void>((resolve) => (this.release = resolve));
    if (session !== undefined && "locks" in navigator) void navigator.locks.request(kLock + session, { mode: "shared" }, () => left);
  }

  private say(message: Omit<Message, "page">): void {
    this.channel.postMessage({ page: this.page, ...message });
  }
}
