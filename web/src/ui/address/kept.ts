// The run that this tab made: a reload, and the way back from the studies, go on with its session. The entry of the
// tab's history names the session, the tab's storage says how it is made again. A copy of the address has neither:
// opened elsewhere it makes a run of its own.
export interface Run {
  session: string;
  /** How the run is made again; without both it is too long for an address. */
  gallery?: string | undefined;
  packed?: string | undefined;
}

const kKey = "truestep-run";

function stored(): Run | undefined {
  try {
    return (JSON.parse(sessionStorage.getItem(kKey) ?? "null") as Run | null) ?? undefined;
  } catch {
    return undefined;
  }
}

export function keepRun(run: Run): void {
  sessionStorage.setItem(kKey, JSON.stringify(run));
}

export function forgetRun(session: string): void {
  if (stored()?.session === session) sessionStorage.removeItem(kKey);
}

/** The run of this tab, if `session` or this entry of its history is it. */
export function keptRun(session: string | undefined): Run | undefined {
  const run = stored();
  return run && run.session === (session ?? (history.state as { session?: string } | null)?.session) ? run : undefined;
}

/** Writes the address of what is on the screen, if it has changed. */
export function writeEntry(session: string, address: string): void {
  const same = `${location.pathname}${location.search}${location.hash}` === address && (history.state as { session?: string } | null)?.session === session;
  if (!same) history.replaceState({ session }, "", address);
}
