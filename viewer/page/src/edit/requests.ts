// Requests to the command.

/** Asks for refusals with the status 200, since a browser writes each other one to its console. */
const quiet = "Pliant-Quiet";
const refused = "application/vnd.pliant.refusal+json";

/** What the command refused, with its reason. */
export class Refusal extends Error {
  constructor(
    readonly status: number,
    readonly errors: { message: string; file?: string; line?: number }[],
  ) {
    super(errors.map(({ message, line }) => (line ? `line ${line}: ${message}` : message)).join("\n") || `the command answered ${status}`);
  }
}

export class Requests {
  /** `lost` is called if the command cannot be reached. */
  constructor(private readonly lost: () => void) {}

  async json<T>(route: string): Promise<T> {
    return (await (await this.ask(route)).json()) as T;
  }

  /** `signal`: gives the request up. */
  async bytes(route: string, signal?: AbortSignal): Promise<ArrayBuffer> {
    return (await this.ask(route, { signal })).arrayBuffer();
  }

  async post<T>(route: string, body: object): Promise<T> {
    const answer = await this.ask(route, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });
    return (await answer.json()) as T;
  }

  private async ask(route: string, how: RequestInit = {}): Promise<Response> {
    let answer: Response;
    try {
      answer = await fetch(route, { cache: "no-store", ...how, headers: { ...how.headers, [quiet]: "yes" } });
    } catch (error) {
      if (how.signal?.aborted) throw error;
      this.lost();
      throw new Error("The command has ended");
    }
    if (answer.ok && answer.headers.get("Content-Type") !== refused) return answer;
    const { status, errors } = (await answer.json().catch(() => ({ errors: [] }))) as { status?: number; errors: Refusal["errors"] };
    throw new Refusal(status ?? answer.status, errors);
  }
}
