// Pictures for the command, which opens the page only for them.

/** Opened by the command, for a picture. */
export const isPicture = location.pathname.endsWith("/take");

/** An order of the command; orders are numbered from 1. */
export type Order<Job> = Job & { number: number; look: string };

const pause = 4; // between questions for an order [ms]

type Body = Blob | Uint8Array<ArrayBuffer>;

/**
 * Sends one picture per order; ends only by an error. While a picture is finished and on its way the
 * next ones are drawn, if they are ordered.
 */
export async function answerOrders<Job>(draw: (order: Order<Job>, isFirst: boolean) => Promise<Body>): Promise<never> {
  let orders: Order<Job>[] = [];
  const take = async (answer: Response) => {
    if (!answer.ok) throw new Error(`the server answered ${answer.status} to the page of pictures`);
    orders = (await answer.json()) as Order<Job>[];
  };
  const mostDrawn = 2; // at the same time
  const drawn: Promise<Body>[] = [];
  let isOver = Promise.resolve();
  for (let done = 0; ; ) {
    const order = orders.find(({ number }) => number > done);
    if (order && drawn.length < mostDrawn) {
      drawn.push(draw(order, done === 0));
      done = order.number;
    } else if (drawn.length > 0) {
      const body = await drawn.shift()!;
      await isOver;
      isOver = fetch("picture", { method: "POST", body }).then(take); // the answer has further orders
    } else {
      await isOver;
      if (orders.some(({ number }) => number > done)) continue;
      await new Promise((resume) => setTimeout(resume, pause));
      await take(await fetch("job"));
    }
  }
}
