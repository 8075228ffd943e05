// From typed text to the request's members. Every field is a text under its JSON pointer.
import type { Parameter } from "../client/studies";
import type { Scene } from "../client/rest";

/** Texts by pointer ("/horizon", "/axes/0/pointer"); a list of objects keeps its length under "/axes#". */
export type Draft = Map<string, string>;

/** Parameters that most people want to set; the others wait under "more". */
const useful = new Set(["integrator", "integrators", "halvings", "a", "b", "axes", "measure", "horizon", "budget"]);

export const isUseful = (parameter: Parameter): boolean => parameter.required === true || useful.has(parameter.name);

const listOf = (text: string): string[] => text.split(/[,;\n]/).map((part) => part.trim()).filter((part) => part !== "");

/** A number if it is one; anything else is sent unchanged, because the service understands units such as "5 ms". */
const numberOf = (text: string): number | string => (text !== "" && Number.isFinite(Number(text)) ? Number(text) : text);

/** The JSON value of a text for a parameter of this kind. */
export function valueOf(kind: string, text: string): unknown {
  if (kind === "number" || kind === "integer") return numberOf(text);
  if (kind === "strings") return listOf(text);
  if (kind === "boolean") return text === "true";
  if (kind !== "numbers") return text;
  const parts = listOf(text);
  const words = text.split(/[\s,;]+/).filter((part) => part !== "");
  return (words.every((word) => typeof numberOf(word) === "number") ? words : parts).map(numberOf);
}

export function countOf(parameter: Parameter, draft: Draft, path: string): number {
  return Number(draft.get(`${path}#`) ?? (parameter.required ? 1 : 0));
}

/** The members that were filled in; empty ones are left to the service. */
export function readDraft(parameters: readonly Parameter[], draft: Draft, base = ""): Record<string, unknown> {
  const out: Record<string, unknown> = {};
  for (const parameter of parameters) {
    const path = `${base}/${parameter.name}`;
    const inner = parameter.parameters ?? [];
    if (parameter.kind === "object") {
      const value = readDraft(inner, draft, path);
      if (Object.keys(value).length > 0) out[parameter.name] = value;
    } else if (parameter.kind === "objects") {
      const count = countOf(parameter, draft, path);
      if (count > 0) out[parameter.name] = Array.from({ length: count }, (_, k) => readDraft(inner, draft, `${path}/${k}`));
    } else {
      const text = draft.get(path)?.trim() ?? "";
      if (text !== "") out[parameter.name] = valueOf(parameter.kind, text);
    }
  }
  return out;
}

/** Placeholder saying what an empty field means. */
export function placeholderOf(parameter: Parameter, scene: Scene | undefined): string {
  if (parameter.name === "horizon") {
    const length = (scene?.time as { duration?: unknown } | undefined)?.duration;
    return length === undefined ? "the scene's duration" : `${String(typeof length === "number" ? +length.toPrecision(6) : length)}`;
  }
  const { default: initial } = parameter;
  if (Array.isArray(initial) || initial === undefined || initial === "") return parameter.required ? "required" : ["values", "min", "max"].includes(parameter.name) ? "optional" : "chosen for you";
  return String(initial);
}

const kMostPointers = 400;

/** JSON pointers to the numbers of a scene that a sweep may vary. */
export function numberPointers(scene: Scene | undefined): string[] {
  const found: string[] = [];
  const walk = (value: unknown, path: string): void => {
    if (found.length >= kMostPointers) return;
    if (typeof value === "number") found.push(path);
    // Long lists hold data, not parameters.
    else if (Array.isArray(value)) value.length <= 8 && value.forEach((item, k) => walk(item, `${path}/${k}`));
    else if (value !== null && typeof value === "object") for (const [key, item] of Object.entries(value)) walk(item, `${path}/${key.replaceAll("~", "~0").replaceAll("/", "~1")}`);
  };
  walk({ systems: scene?.systems, time: scene?.time, gravity: scene?.gravity }, "");
  return found;
}

export interface SystemOfScene {
  id: string;
  type: string;
}

export function systemsOf(scene: Scene | undefined): SystemOfScene[] {
  const systems = Array.isArray(scene?.systems) ? (scene.systems as { id?: unknown; type?: unknown }[]) : [];
  return systems.map((system) => ({ id: String(system.id ?? system.type ?? ""), type: String(system.type ?? "") }));
}

/** The deepest of `fields` that contains an issue's pointer; undefined when there is none. */
export function fieldOf(pointer: string, fields: readonly string[]): string | undefined {
  return fields.filter((field) => pointer === field || pointer.startsWith(`${field}/`)).sort((a, b) => b.length - a.length)[0];
}
