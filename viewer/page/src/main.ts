// The page of `pliant view`: shows the bake in it or that of the command, or sends pictures of it.

import { bytesOf, unpack } from "./bake";
import { element } from "./element";
import { firstBake, follow } from "./live";
import { defined, readLook } from "./look";
import { showMessages } from "./messages";
import { answerOrders, isPicture } from "./orders";
import { apply, labelled, load, playback, showLive, stage, start, themes, viewer } from "./page";
import { takePicture, type PictureJob } from "./picture";

const badges = { working: ["baking", "working"], failed: ["error", "failed"], baked: ["live", "ready"] } as const;

function goLive(): void {
  follow({
    baked(bake) {
      const isFirst = viewer.bake === null;
      load(bake);
      if (isFirst) apply(readLook(location.hash));
    },
    told(status, messages) {
      if (messages.length > 0) showMessages(element("messages"), messages);
      const [text, state] = badges[status];
      showLive(text, state);
    },
    lost: () => showLive("stopped", "failed"),
  });
}

/**
 * `pliant view --png` and `--movie` open the page only for this: it sends one picture per order.
 */
async function sendPictures(): Promise<void> {
  document.documentElement.style.display = "none"; // nobody looks at the page, and drawing it takes time
  load(await firstBake());
  await answerOrders<PictureJob>((order, isFirst) => {
    if (isFirst) apply({ theme: "light", ...defined(readLook(order.look)) });
    return takePicture(viewer, themes, order);
  });
}

async function begin(): Promise<void> {
  const text = element<HTMLScriptElement>("bake").textContent ?? "";
  if (text !== "") {
    load(await unpack(bytesOf(text)));
    element("bake").remove();
    apply(readLook(location.hash));
  } else if (isPicture) {
    await sendPictures();
  } else {
    goLive();
  }
}

start(begin);

// For tests, and for inspecting a page from the console.
Object.assign(window, { pliant: { viewer, stage, playback, themes, labels: () => labelled } });
