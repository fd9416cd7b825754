// The page of a sweep: pictures of takes, plots of measures, the table; and what connects them.

import { bytesOf, inflate, type Message } from "../bake";
import { element } from "../element";
import { showLegend, titles, type Legend } from "../legend";
import { fetchPacked } from "../live";
import { defined, readLook, type Look } from "../look";
import { showMessages } from "../messages";
import { numberText } from "../curve_plot";
import { answerOrders, isPicture } from "../orders";
import { displacementRamp } from "../ramp";
import "../style.css";
import { ThemeChoice } from "../theme";
import { ContactSheet, type TileSize } from "./contact_sheet";
import { Details } from "./details";
import { drawSheet, type SheetJob } from "./picture";
import { PlotGrid, type Kind } from "./plot_grid";
import { Pointing } from "./pointing";
import type { ScaleChoice } from "./scales";
import { Studio } from "./studio";
import "./style.css";
import { Sweep } from "./sweep";
import { TakeTable } from "./table";

const themes = new ThemeChoice();
const counted = (count: number, one: string) => `${count.toLocaleString("en")} ${one}${count === 1 ? "" : "s"}`;

function legendOf(studio: Studio): Legend {
  return {
    scale: { title: titles.displacement, css: displacementRamp.css(), at: (share) => displacementRamp.cssAt(share), low: "0", high: numberText(studio.peak), frames: "" },
    inks: [],
  };
}

function summaryOf({ head }: Sweep): string {
  const missing = head.takes - head.done - head.failed;
  return [counted(head.takes, "take"), `${head.done.toLocaleString("en")} done`, head.failed > 0 ? `${head.failed.toLocaleString("en")} failed` : "", missing > 0 ? `${missing.toLocaleString("en")} missing` : ""]
    .filter(Boolean)
    .join(" · ");
}

/** What the pictures do not show. */
function sheetNote(sweep: Sweep, studio: Studio): string {
  if (!studio.canDraw) return "This browser cannot draw the takes, since it has no WebGL 2. Plots and table need none.";
  const notes: string[] = [];
  const { head, shapes } = sweep;
  if (shapes.length === 0) notes.push("No take is done that could be shown.");
  else if (shapes.length + head.failures.length < head.done) notes.push(`${counted(shapes.length, "take")} of the ${head.done.toLocaleString("en")} that are done, evenly spread.`);
  const coarse = shapes.filter(({ shown, vertices }) => shown < vertices);
  if (coarse.length > 0) {
    const [one] = coarse;
    notes.push(`${coarse.length === shapes.length ? "Meshes are" : `${coarse.length} meshes are`} drawn coarser than they are, take ${sweep.takes[one.row]} with ${one.shown.toLocaleString("en")} of ${one.vertices.toLocaleString("en")} vertices.`);
  }
  const giants = shapes.filter(({ isGiant }) => isGiant).length;
  if (giants > 0) notes.push(`${counted(giants, "take")} so much larger than the rest ${giants === 1 ? "is" : "are"} not fitted into the pictures and the colours.`);
  return notes.join(" ");
}

const mostReasons = 3;

/** By which a key turns the camera. [degrees] */
const turnStep = 10;

/** Why takes have no picture or failed, the most frequent reasons first. */
function failuresOf(sweep: Sweep): Message[] {
  const { head, takes } = sweep;
  const messages: Message[] = [];
  const add = (kind: Message["kind"], failures: [take: number, text: string][], what: [one: string, more: string], hasAll: boolean) => {
    const takesOf = new Map<string, number[]>();
    for (const [take, text] of failures) {
      const same = takesOf.get(text);
      if (same) same.push(take);
      else takesOf.set(text, [take]);
    }
    const reasons = [...takesOf].sort(([, a], [, b]) => b.length - a.length);
    for (const [text, [first, ...more]] of reasons.slice(0, mostReasons)) {
      const count = more.length === 0 ? "" : ` and ${hasAll ? "" : "at least "}${more.length.toLocaleString("en")} more`;
      messages.push({ kind, line: 0, text: `take ${first}${count} ${what[more.length === 0 ? 0 : 1]}: ${text}` });
    }
    if (reasons.length > mostReasons) messages.push({ kind, line: 0, text: `takes ${what[1]} for ${counted(reasons.length - mostReasons, "more reason")}; point at one to see it` });
  };
  add("error", head.conflicts.map(({ take, text }) => [take, text]), ["was run twice", "were run twice"], true);
  add("error", head.failures.map(({ take, text }) => [take, text]), ["has no picture", "have no picture"], true);
  const failed = [...takes.keys()].filter((row) => sweep.stateOf(row) === "failed");
  add("warning", failed.map((row) => [takes[row], sweep.errorOf(row)]), ["failed", "failed"], sweep.hasAllTakes);
  return messages;
}

function load(sweep: Sweep): { apply: (look: Look) => void; sheet: ContactSheet } {
  const { name } = sweep.head;
  document.title = `${name} – pliant`;
  element("sweep-name").textContent = name;
  const summary = element<HTMLElement>("summary");
  summary.textContent = summary.title = summaryOf(sweep);
  const studio = new Studio(sweep);
  const pointing = new Pointing();
  const details = new Details(element("details"), sweep, studio, pointing, themes);
  const sheet = new ContactSheet(element("tiles"), sweep, studio, pointing, themes);
  const table = new TakeTable(element("table"), sweep, pointing);
  const plots = new PlotGrid(element("plots"), element("plots-note"), sweep, pointing, themes);
  const note = element<HTMLElement>("sheet-note");
  note.textContent = sheetNote(sweep, studio);
  note.hidden = note.textContent === "";
  showMessages(element("messages"), failuresOf(sweep));
  element("table-note").textContent = sweep.hasAllTakes ? "" : `${sweep.rowCount.toLocaleString("en")} of ${counted(sweep.head.takes, "take")}, evenly spread; takes.csv has all.`;

  const redrawTakes = () => {
    showLegend(element("legend"), sweep.shapes.length > 0 && studio.canDraw ? legendOf(studio) : null);
    sheet.redraw();
    details.draw();
  };
  sheet.onTurn = redrawTakes;
  const peak = element<HTMLInputElement>("peak");
  const setPeak = (value: number | null) => {
    studio.setPeak(value);
    peak.value = value === null ? "" : String(value);
    peak.placeholder = numberText(studio.peak);
    redrawTakes();
  };
  peak.addEventListener("change", () => setPeak(peak.valueAsNumber > 0 ? peak.valueAsNumber : null));
  const size = (value: string) => (sheet.size = value as TileSize);
  for (const radio of document.querySelectorAll<HTMLInputElement>('input[name="size"]')) radio.addEventListener("change", () => size(radio.value));
  size("medium");

  // Order of the table and of the pictures
  const order = element<HTMLSelectElement>("order");
  table.columns.forEach(({ title }, k) => {
    for (const [value, text] of [[`${k}`, title], [`-${k}`, `${title}, falling`]]) order.add(new Option(text, value));
  });
  order.addEventListener("change", () => table.sort(Math.abs(Number(order.value)), order.value.startsWith("-")));
  table.onChange(() => {
    order.value = `${table.isDescending ? "-" : ""}${table.sortedBy}`;
    sheet.order(table.order);
  });

  // Plots
  const kinds = [...document.querySelectorAll<HTMLInputElement>('input[name="kind"]')];
  const fields = ["across", "up"] as const;
  const build = () => {
    plots.kind = (kinds.find((radio) => radio.checked)?.value ?? "lines") as Kind;
    for (const field of fields) element<HTMLElement>(`${field}-field`).hidden = plots.kind !== "map";
    element("value-scale").parentElement!.hidden = plots.kind === "map";
    plots.build();
  };
  element<HTMLElement>("kind").hidden = !plots.hasMaps;
  kinds.forEach((radio) => radio.addEventListener("change", build));
  for (const field of fields) {
    const select = element<HTMLSelectElement>(field);
    for (const axis of plots.mapAxes) select.add(new Option(sweep.paths[sweep.head.axes[axis].paths[0]].title, String(axis)));
    select.value = String(plots[field]);
    select.addEventListener("change", () => {
      const [chosen, other] = [Number(select.value), field === "up" ? "across" : "up"] as const;
      if (plots[other] === chosen) {
        plots[other] = plots[field];
        element<HTMLSelectElement>(other).value = String(plots[other]);
      }
      plots[field] = chosen;
      build();
    });
  }
  for (const [id, set] of [["value-scale", (to: ScaleChoice) => (plots.valueScale = to)], ["measure-scale", (to: ScaleChoice) => (plots.measureScale = to)]] as const) {
    const select = element<HTMLSelectElement>(id);
    select.addEventListener("change", () => {
      set(select.value as ScaleChoice);
      build();
    });
  }
  build();

  // Buttons and keys
  const frameAll = () => {
    studio.look();
    redrawTakes();
  };
  const help = element<HTMLDialogElement>("help");
  element("frame-all").addEventListener("click", frameAll);
  element("theme").addEventListener("click", () => themes.toggle());
  element("help-toggle").addEventListener("click", () => help.showModal());
  for (const link of document.querySelectorAll<HTMLElement>("nav a")) {
    link.addEventListener("click", (event) => {
      event.preventDefault(); // the address has the look
      element(link.dataset.part!).scrollIntoView({ behavior: matchMedia("(prefers-reduced-motion: reduce)").matches ? "auto" : "smooth" });
    });
  }
  const said = element("said");
  const step = (by: number) => {
    const row = table.beside(pointing.row, by);
    pointing.keep(row, "keys");
    said.textContent = sweep.inWords(row);
  };
  const turn = (by: number, tilt: number) => {
    studio.turnBy(by, tilt);
    redrawTakes();
  };
  const shortcuts: Record<string, () => void> = {
    ArrowLeft: () => step(-1),
    ArrowRight: () => step(1),
    "Shift+ArrowLeft": () => turn(-turnStep, 0),
    "Shift+ArrowRight": () => turn(turnStep, 0),
    "Shift+ArrowUp": () => turn(0, turnStep),
    "Shift+ArrowDown": () => turn(0, -turnStep),
    Escape: () => pointing.keep(null, "keys"),
    c: () => void details.copy().then((words) => (said.textContent = words)),
    f: frameAll,
    t: () => themes.toggle(),
    "?": () => help.showModal(),
  };
  document.addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey || help.open || target.matches("input, select")) return;
    const isInTable = target.matches("#table") && !event.shiftKey;
    const key = event.key.length === 1 ? event.key.toLowerCase() : `${event.shiftKey ? "Shift+" : ""}${event.key}`;
    // The table's own arrows: up and down go on, left and right show its other columns.
    const shortcut = isInTable && key.startsWith("Arrow") ? { ArrowUp: () => step(-1), ArrowDown: () => step(1) }[key] : shortcuts[key];
    if (!shortcut) return;
    event.preventDefault();
    shortcut();
  });

  const apply = (look: Look) => {
    if (look.theme) themes.choose(look.theme);
    if (look.up) studio.up = look.up;
    if (look.turn !== undefined || look.tilt !== undefined) studio.look(look.turn, look.tilt);
    setPeak(look.peak !== undefined && look.peak > 0 ? look.peak : null);
    const take = new URLSearchParams(location.hash.slice(1)).get("take");
    const row = take ? sweep.row(Number(take)) : undefined;
    if (row !== undefined) pointing.keep(row, "address");
  };
  // For tests, and for inspecting a page from the console.
  Object.assign(window, { pliant: { sweep, studio, pointing, table, plots, themes } });
  return { apply, sheet };
}

/** `pliant sweep view --png` opens the page only for this. */
async function sendPictures(): Promise<void> {
  const sweep = new Sweep(await inflate(await fetchPacked()));
  const studio = new Studio(sweep);
  if (!studio.canDraw) throw new Error("the browser has no WebGL 2");
  await answerOrders<SheetJob>((order) => {
    const look = { theme: "light" as const, ...defined(readLook(order.look)) };
    themes.choose(look.theme);
    if (look.up) studio.up = look.up;
    studio.look(look.turn, look.tilt);
    if (look.peak !== undefined && look.peak > 0) studio.setPeak(look.peak);
    return drawSheet(sweep, studio, legendOf(studio), `${sweep.head.name}: ${summaryOf(sweep)}`, themes.palette, order);
  });
}

async function begin(): Promise<void> {
  if (isPicture) return sendPictures();
  const text = element<HTMLScriptElement>("bake").textContent ?? "";
  const { apply, sheet } = load(new Sweep(await inflate(bytesOf(text))));
  element("bake").remove();
  apply(readLook(location.hash));
  addEventListener("hashchange", () => apply(readLook(location.hash)));
  await sheet.drawn(false);
  document.documentElement.dataset.ready = "true";
  performance.mark("ready");
  await sheet.drawn(true);
  document.documentElement.dataset.whole = "true";
  performance.mark("whole");
}

begin().catch((error: Error) => {
  showMessages(element("messages"), [{ kind: "error", line: 0, text: `This page cannot be shown: ${error.message}` }]);
});
