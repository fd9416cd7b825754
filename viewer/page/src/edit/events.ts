// What the command tells by itself. Of all pages in a browser one listens and passes it on: a browser opens only a few
// connections to a host, and each page that listened would keep one.

/** An event of that name with its data; to one page, or to all. */
interface Passed {
  name: string;
  data: string;
  to?: string;
}

const retryAfter = 1000; // [ms]

/** Calls what has the name of the event, and `lost` when the command cannot be reached. */
export function listen(takers: Record<string, (told: never) => void>): void {
  const [group, self] = [location.pathname, crypto.randomUUID()];
  const channel = new BroadcastChannel(group);
  /** The last of each name, in the page that listens. */
  const last = new Map<string, string>();
  const take = ({ name, data }: Passed) => takers[name]?.(JSON.parse(data) as never);
  const pass = (passed: Passed) => {
    channel.postMessage(passed);
    take(passed);
  };
  const open = () => {
    const events = new EventSource("events");
    for (const name of Object.keys(takers)) {
      events.addEventListener(name, ({ data }: MessageEvent<string>) => {
        last.set(name, data);
        pass({ name, data });
      });
    }
    events.addEventListener("error", () => {
      pass({ name: "lost", data: "null" });
      if (events.readyState === EventSource.CLOSED) setTimeout(open, retryAfter);
    });
  };
  channel.addEventListener("message", ({ data: passed }: MessageEvent<Passed>) => {
    const { name, to } = passed;
    if (name === "join") for (const [each, data] of last) channel.postMessage({ name: each, data, to });
    else if (to === undefined || to === self) take(passed);
  });
  channel.postMessage({ name: "join", data: "", to: self });
  // When the page that listens is closed, the next one does.
  void navigator.locks.request(group, () => {
    open();
    return new Promise(() => {});
  });
}
