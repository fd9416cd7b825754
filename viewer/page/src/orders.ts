// Pictures for the command, which opens the page only for them.

/** Opened by the command, for a picture. */
export const isPicture = location.pathname.endsWith("/take");

/** An order of the command; orders are numbered from 1. */
export type Order<Job> = Job & { number?: number; look: string };

async function nextOrder<Job>(done: number): Promise<Order<Job>> {
  for (;;) {
    const order = (await (await fetch("job")).json()) as Order<Job>;
    if ((order.number ?? 0) > done) return order;
    await new Promise((resume) => setTimeout(resume, 4));
  }
}

/** Sends one picture per order; ends only by an error. */
export async function answerOrders<Job>(draw: (order: Order<Job>, isFirst: boolean) => Promise<Blob>): Promise<never> {
  for (let done = 0; ; ) {
    const order = await nextOrder<Job>(done);
    const picture = await draw(order, done === 0);
    done = order.number!;
    const answer = await fetch("picture", { method: "POST", body: picture });
    if (!answer.ok) throw new Error(`the server answered ${answer.status} to the picture`);
  }
}
