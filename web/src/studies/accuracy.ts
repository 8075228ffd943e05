// The service's answer to a scene that asked for an accuracy, as a paragraph.
import { duration, quantity } from "./numbers";

/** A session's "accuracy": the method chosen for the tolerance, and the measurements behind the choice. */
export interface Accuracy {
  tolerance: number;
  quantity?: string;
  chosen?: { integrator: string; tolerance?: number; step?: number; error?: number | null };
  measured?: unknown[];
  note?: string;
}

export function accuracyWords({ tolerance, quantity: what = "position", chosen, measured, note }: Accuracy): string {
  const sentences: string[] = [];
  if (chosen) {
    const setting = chosen.step !== undefined ? ` with a step of ${duration(chosen.step)}` : chosen.tolerance !== undefined ? ` at tolerance ${quantity(chosen.tolerance)}` : "";
    const error = typeof chosen.error === "number" ? `, measured ${quantity(chosen.error, 2)}` : "";
    const among = measured && measured.length > 1 ? ` of ${measured.length} runs measured` : "";
    sentences.push(`${chosen.integrator}${setting} is the cheapest${among} whose error of ${what} stays within ${quantity(tolerance)}${error}.`);
  }
  if (note) sentences.push(note.charAt(0).toUpperCase() + note.slice(1) + (/[.!?]$/.test(note) ? "" : "."));
  return sentences.join(" ");
}
