// What each page has: the stage with what is shown on it, and the buttons, keys and panels around it.

import type { ShownBake } from "./bake";
import { numberText } from "./curve_plot";
import { CurvePanel } from "./curves";
import { element } from "./element";
import { ForceList } from "./force_list";
import { FrameAxis } from "./frame_axis";
import { drawLabels } from "./labels";
import { legendOf, showLegend } from "./legend";
import { readLook, type Look } from "./look";
import { showMessages } from "./messages";
import { isPicture } from "./orders";
import { Readout } from "./readout";
import "./style.css";
import type { Colour, Style } from "./surface_view";
import { ThemeChoice } from "./theme";
import { prepare, textSize, Timeline } from "./timeline";
import { Viewer } from "./viewer";

export const themes = new ThemeChoice();
export const viewer = new Viewer(element("view"), themes);
export const { playback, stage, display } = viewer;
export const axis = new FrameAxis(element("timeline"), playback);
export const timeline = new Timeline(element("timeline"), playback, axis, themes);
export const curves = new CurvePanel(element("channels"), element("curve-view"), element("curve-values"), playback, axis, themes);
const forceList = new ForceList(element("forces"), element("show-all"), viewer.forces);
export const readout = new Readout(stage, element("readout"), playback, themes);

// Playback

export const button = (id: string, press: () => void) => element<HTMLButtonElement>(id).addEventListener("click", press);
const frameField = element<HTMLInputElement>("frame");
const loopButton = element<HTMLButtonElement>("loop");

function toggleLoop(): void {
  playback.isLooping = !playback.isLooping;
  loopButton.setAttribute("aria-pressed", String(playback.isLooping));
}

button("play", () => playback.toggle());
button("back", () => playback.step(-1));
button("on", () => playback.step(1));
button("to-start", () => playback.goTo(playback.first));
button("to-end", () => playback.goTo(playback.last));
button("loop", toggleLoop);
frameField.addEventListener("change", () => {
  playback.pause();
  playback.goTo(frameField.valueAsNumber);
  frameField.value = String(playback.frame);
});
element<HTMLSelectElement>("speed").addEventListener("change", (event) => {
  playback.speed = Number((event.target as HTMLSelectElement).value);
});

let wasPlaying = false;
playback.onChange(() => {
  if (document.activeElement !== frameField || playback.isPlaying) frameField.value = String(playback.frame);
  readout.update();
  if (playback.isPlaying === wasPlaying) return;
  wasPlaying = playback.isPlaying;
  element("play-icon").setAttribute("href", wasPlaying ? "#icon-pause" : "#icon-play");
  element("play").setAttribute("aria-label", wasPlaying ? "Pause" : "Play");
});

// Display

function check(id: string, take: (isOn: boolean) => void): (isOn: boolean) => void {
  const box = element<HTMLInputElement>(id);
  box.addEventListener("change", () => take(box.checked));
  return (isOn) => {
    box.checked = isOn;
    take(isOn);
  };
}

function choice<T extends string>(name: string, take: (value: T) => void): (value: T) => void {
  const radios = [...document.querySelectorAll<HTMLInputElement>(`input[name="${name}"]`)];
  for (const radio of radios) radio.addEventListener("change", () => take(radio.value as T));
  return (value) => {
    for (const radio of radios) radio.checked = radio.value === value;
    take(value);
  };
}

const setStyle = choice<Style>("style", (style) => {
  display.style = style;
  redress();
});
const setColour = choice<Colour>("colour", (colour) => {
  display.colour = colour;
  redress();
});
const setGizmos = check("show-gizmos", (isOn) => {
  display.hasGizmos = isOn;
  redress();
});
const setLabels = check("show-labels", (isOn) => {
  display.hasLabels = isOn;
  redress();
});
const setRegions = check("show-regions", (isOn) => {
  display.hasRegions = isOn;
  redress();
});
const setBoxes = check("show-boxes", (isOn) => {
  display.hasBoxes = isOn;
  redress();
});
const setColliders = check("show-colliders", (isOn) => {
  display.hasColliders = isOn;
  redress();
});
const setFloor = check("show-floor", (isOn) => (stage.hasFloor = isOn));
check("interpolate", (isOn) => {
  playback.isBetween = isOn;
  playback.goTo(playback.frame);
});

function redress(): void {
  viewer.redress();
  updateLegend();
}

export function updateLegend(): void {
  showLegend(element("legend"), legendOf(viewer, themes.palette));
}
themes.onChange(updateLegend);

const labels = element<HTMLCanvasElement>("labels");
export let labelled: string[] = [];
stage.onDraw(() => {
  const place = prepare(labels);
  if (place) labelled = drawLabels(place.context, viewer.labels(), stage.camera, { ...place, text: textSize() }, [], themes.palette);
});

/** Writes the choice into the address, so that it can be shared, and passed to --look. A page in a frame of another
 * one, such as a notebook, has no address of its own. */
viewer.forces.onChange(() => {
  updateLegend();
  const words = viewer.forces.writtenTo(location.hash);
  const hasAddress = location.protocol !== "about:";
  if (!isPicture && hasAddress) history.replaceState(null, "", words === "" ? location.pathname + location.search : `#${words}`);
});

function togglePanel(id: string, buttonId: string, attribute: string): void {
  const panel = element<HTMLElement>(id);
  panel.hidden = !panel.hidden;
  element(buttonId).setAttribute(attribute, String(!panel.hidden));
  curves.draw();
}
const toggleCurves = () => togglePanel("curves", "curves-toggle", "aria-pressed");
const toggleDisplay = () => togglePanel("display", "display-toggle", "aria-expanded");

button("curves-toggle", toggleCurves);
button("display-toggle", toggleDisplay);
button("theme", () => themes.toggle());
button("frame-all", () => stage.frameAll());
const help = element<HTMLDialogElement>("help");
function openHelp(): void {
  help.showModal();
  help.scrollTop = 0; // the button that gets the focus is at its end
}
button("help-toggle", openHelp);

// Keys

function next<T>(all: readonly T[], now: T): T {
  return all[(all.indexOf(now) + 1) % all.length];
}

const shortcuts: Record<string, (event: KeyboardEvent) => void> = {
  " ": () => playback.toggle(),
  ArrowLeft: (event) => playback.step(event.shiftKey ? -10 : -1),
  ArrowRight: (event) => playback.step(event.shiftKey ? 10 : 1),
  ArrowUp: () => timeline.toKey(-1),
  ArrowDown: () => timeline.toKey(1),
  Home: () => playback.goTo(playback.first),
  End: () => playback.goTo(playback.last),
  f: () => stage.frameAll(),
  l: toggleLoop,
  w: () => setStyle(next(["shaded", "lines", "wireframe"] as const, display.style)),
  v: () => setColour(next(["displacement", "signed", "velocity", "plain"] as const, display.colour)),
  g: () => {
    const isOn = !display.hasGizmos;
    for (const set of [setGizmos, setRegions, setBoxes]) set(isOn);
  },
  n: () => setLabels(!display.hasLabels),
  c: toggleCurves,
  d: toggleDisplay,
  t: () => themes.toggle(),
  "?": openHelp,
};

document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || help.open) return;
  const target = event.target as HTMLElement;
  const shortcut = shortcuts[event.key.length === 1 ? event.key.toLowerCase() : event.key];
  // Fields and buttons keep the keys that operate them.
  const isField = target.matches("input:not([type=checkbox]), select, textarea");
  const isPressed = event.key === " " && target.matches("button, input, summary, [role=option]");
  if (!shortcut || isField || isPressed) return;
  event.preventDefault();
  shortcut(event);
});

// Content

export function load(bake: ShownBake): void {
  const { head } = bake;
  const name = head.scene.split("/").pop() ?? head.scene;
  document.title = `${name} – pliant`;
  element("scene-name").textContent = name;
  const vertices = head.surfaces.reduce((sum, each) => sum + each.vertices, 0);
  const error = Math.max(0, ...head.surfaces.map((each) => each.error));
  const summary = element<HTMLElement>("summary");
  summary.textContent = `${bake.frameCount} ${bake.frameCount === 1 ? "frame" : "frames"} · ${Number(head.fps.toPrecision(5))} fps · ${vertices.toLocaleString("en")} vertices`;
  summary.title = `Positions on this page differ from the baked ones by at most ${numberText(error)}`;
  frameField.min = String(head.first);
  frameField.max = String(head.last);
  timeline.keyFrames = [...new Set(head.channels.flatMap((channel) => channel.keys.map((key) => key.at[0])))].sort((a, b) => a - b);
  readout.clear();
  viewer.load(bake);
  setColour(display.colour);
  readout.views = viewer.views;
  curves.load(head.channels);
  readout.colliders = viewer.colliders;
  forceList.load(head.forces, head.colliders ?? []);
  element<HTMLInputElement>("show-colliders").closest("label")!.hidden = viewer.colliders.length === 0;
  updateLegend();
  showMessages(element("messages"), head.messages);
  element("view").setAttribute("aria-label", `${head.surfaces.map((each) => each.name).join(", ")}: ${bake.frameCount} frames, ${head.forces.length} forces${head.colliders ? `, ${head.colliders.length} colliders` : ""}`);
}

export function apply(look: Look): void {
  if (look.theme) themes.choose(look.theme);
  if (look.legend !== undefined) display.hasLegend = look.legend;
  if (look.caption !== undefined) display.hasCaption = look.caption;
  if (look.peak !== undefined && look.peak > 0) display.peak = look.peak;
  if (look.style) setStyle(look.style);
  if (look.colour) setColour(look.colour);
  if (look.gizmos !== undefined) setGizmos(look.gizmos);
  if (look.regions !== undefined) setRegions(look.regions);
  if (look.boxes !== undefined) setBoxes(look.boxes);
  if (look.colliders !== undefined) setColliders(look.colliders);
  if (look.labels !== undefined) setLabels(look.labels);
  if (look.hide || look.solo) viewer.forces.set(look.hide, look.solo);
  if (look.floor !== undefined) setFloor(look.floor);
  if (look.frame !== undefined) playback.goTo(look.frame);
  redress();
  if (look.up) stage.up = look.up;
  if (look.up || look.turn !== undefined || look.tilt !== undefined) stage.look(look.turn, look.tilt);
  else if (look.gizmos !== undefined || look.colliders !== undefined || look.hide || look.solo) stage.frameAll(); // other things are drawn
}

export function showLive(text: string, state: string): void {
  const live = element<HTMLElement>("live");
  live.hidden = false;
  live.textContent = text;
  live.dataset.state = state;
}

/** Runs a page from its beginning, and says in it why it cannot be shown. */
export function start(begin: () => Promise<void>): void {
  addEventListener("hashchange", () => apply(readLook(location.hash)));
  begin()
    .then(() => {
      document.documentElement.dataset.ready = "true";
      performance.mark("ready");
    })
    .catch((error: Error) => {
      showMessages(element("messages"), [{ kind: "error", line: 0, text: `This page cannot be shown: ${error.message}` }]);
    });
}
