// RFC 9457 problems: what the service answers when it refuses something, as an exception.

/** One thing wrong with an input; `pointer` is an RFC 6901 JSON pointer into the body that was sent. */
export interface Issue {
  pointer: string;
  code: string;
  message?: string;
  value?: unknown;
  allowed?: unknown;
  did_you_mean?: string;
  unit?: string;
}

/** The members of an application/problem+json body that the viewer shows. */
export interface Problem {
  type?: string;
  title: string;
  status: number;
  code: string;
  detail?: string;
  trace_id?: string;
  errors?: Issue[];
  warnings?: Issue[];
  suggestions?: Issue[];
  [extension: string]: unknown;
}

/** A refused request. `problem.status` is 0 when no answer came at all. */
export class ProblemError extends Error {
  constructor(readonly problem: Problem) {
    super(problem.detail ?? problem.title);
    this.name = "ProblemError";
  }
}

/** The problem that any thrown value stands for. */
export function problemOf(error: unknown): Problem {
  if (error instanceof ProblemError) return error.problem;
  const detail = error instanceof Error ? error.message : String(error);
  return { title: "Something went wrong in the viewer", status: 0, code: "viewer_error", detail };
}

/** The problem of an HTTP answer; an answer that is no problem+json still gives a readable one. */
export async function problemOfResponse(response: Response): Promise<Problem> {
  const fallback: Problem = {
    title: response.statusText || "The request failed",
    status: response.status,
    code: "http_error",
    detail: `${new URL(response.url, "http://localhost").pathname} answered ${response.status}`,
  };
  if (!(response.headers.get("content-type") ?? "").includes("json")) return fallback;
  try {
    const body: unknown = await response.json();
    if (typeof body !== "object" || body === null) return fallback;
    return { ...fallback, detail: undefined, ...body };
  } catch {
    return fallback;
  }
}
