// Studies as described by the service: kinds with parameter tables, operations, results.
import type { Issue } from "./problem";

/** One row of a parameter table; `kind` is number, integer, numbers, string, strings, choice, object or objects. */
export interface Parameter {
  name: string;
  kind: string;
  description?: string;
  unit?: string;
  allowed?: string;
  default?: unknown;
  required?: boolean;
  choices?: string[];
  parameters?: Parameter[];
}

export interface StudyKind {
  kind: string;
  sentence: string;
  parameters: Parameter[];
}

export type Summary = Record<string, unknown>;

export interface Operation {
  id: string;
  kind: string;
  status: "waiting" | "running" | "done" | "failed" | "cancelled";
  /** 0 to 1. */
  progress: number;
  note: string;
  links: Record<string, string>;
  error?: { code: string; detail: string; errors?: Issue[] };
  summary?: Summary;
}

export type Cell = number | string | null | undefined;
export type Row = Record<string, Cell>;
export type Scale = "linear" | "log";

export interface Series {
  name: string;
  x: (number | null)[];
  y: (number | null)[];
}

export interface StudyResult {
  summary: Summary;
  columns: { name: string; unit: string }[];
  rows: Row[];
  plot: { title: string; x_label: string; y_label: string; x_scale: Scale; y_scale: Scale; series: Series[] };
}

/** A method of a system, as GET /v1/systems/{type} lists it. */
export interface Method {
  name: string;
  title?: string;
  order?: number;
}

export const ended = (operation: Operation): boolean => !["waiting", "running"].includes(operation.status);
