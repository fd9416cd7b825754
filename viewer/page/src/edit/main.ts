// The page of `pliant edit`: the viewer's, in which everything can be changed.

import { element } from "../element";
import { readLook } from "../look";
import { showMessages } from "../messages";
import { apply, axis, curves, labelled, load, playback, readout, stage, start, themes, timeline, updateLegend, viewer } from "../page";
import { CurveKeys } from "./curve_keys";
import { mountCurveTools } from "./curve_tools";
import { mountDocumentBar, noticeDisk } from "./document_bar";
import { Editor } from "./editor";
import "./edit.css";
import { listen } from "./events";
import { ExportDialog, type ExportState } from "./export_dialog";
import { mountFirstScreen } from "./first_screen";
import { mountHandles } from "./handles";
import { LiveScene } from "./live_scene";
import { mountOutliner } from "./outliner";
import { extraGroups, mountProperties } from "./properties";
import { mountRecordBar } from "./record_bar";
import { mountPicking } from "./picking";
import { motionGroup } from "./motion";
import type { Refusal } from "./requests";
import { Session } from "./session";
import { mountShortcuts } from "./shortcuts";
import { Takes, type TakesFacts } from "./takes";
import { TimelineKeys } from "./timeline_keys";
import { mountTextPanel } from "./text_panel";

const session = new Session();
const scene = new LiveScene(session);
const editor = new Editor(session, scene, viewer);
mountOutliner(editor);
mountProperties(editor);
extraGroups.push(motionGroup);

let peak = 0;
scene.onChange((isNew) => {
  if (!scene.head) return;
  if (isNew) {
    const isFirst = viewer.bake === null;
    load(scene);
    if (isFirst) apply(readLook(location.hash));
  } else {
    viewer.redraw();
    showMessages(element("messages"), scene.head.messages);
    const { high } = viewer.ends();
    if (high !== peak) updateLegend();
    peak = high;
  }
  readout.update();
});
playback.onChange(() => scene.goTo(playback.frame));
playback.mayShow = (frame) => scene.isReady(frame);
mountPicking(editor);
mountHandles(editor, themes);
const curveKeys = new CurveKeys(editor, curves, element("curve-view"));
mountCurveTools(editor, curves, curveKeys);
mountShortcuts(editor, curveKeys, new TimelineKeys(editor, element("timeline"), timeline, axis));

mountDocumentBar(editor);
mountRecordBar(editor, timeline);
mountFirstScreen(editor);
mountTextPanel(editor);
const exporting = new ExportDialog(editor);
const takes = new Takes(editor, themes);

start(async () => {
  await session.open();
  listen({
    revision: (revision: number) => session.take(revision),
    frames: ({ revision, ready }: { revision: number; ready: [number, number][] }) => scene.takeReady(revision, ready),
    failed: ({ revision, errors }: { revision: number; errors: Refusal["errors"] }) => session.fail(revision, errors),
    disk: () => noticeDisk(editor),
    export: (told: ExportState) => exporting.take(told),
    takes: (told: TakesFacts) => takes.take(told),
    lost: () => session.lose(),
  });
  if (session.facts.text !== null) await scene.readScene();
});

// For tests, and for inspecting a page from the console.
Object.assign(window, {
  pliant: {
    viewer,
    stage,
    playback,
    themes,
    labels: () => labelled,
    edit: {
      session,
      scene,
      editor,
      shown() {
        const { solved, isExact } = scene.shown;
        const positions = Object.fromEntries(scene.surfaces.map(({ head }, k) => [head.name, solved?.positions[k] ?? new Float32Array()]));
        return { revision: solved?.revision ?? session.revision, frame: playback.frame, exact: isExact, positions };
      },
      ghosts: () => takes.ghosts.shown,
    },
  },
});
