// What belongs to recordings: their button, speed and tolerance, what they made, and their frames on the timeline.

import { element } from "../element";
import { button } from "../page";
import type { Timeline } from "../timeline";
import type { Editor } from "./editor";
import { NumberField } from "./number_field";
import { Problem } from "./problem";

export function mountRecordBar(editor: Editor, timeline: Timeline): void {
  const { recorder, session } = editor;
  const [bar, account, speed] = [element<HTMLElement>("record-bar"), element<HTMLElement>("record-account"), element<HTMLSelectElement>("record-speed")];
  button("record", () => (recorder.isOn = !recorder.isOn));
  speed.addEventListener("change", () => (recorder.speed = Number(speed.value)));
  const tolerance = toleranceField(editor, new Problem(element("record-problem"), session));
  element("record-tolerance").append(tolerance.input);

  const update = () => {
    element("record").setAttribute("aria-pressed", String(recorder.isOn));
    bar.hidden = !recorder.isOn && recorder.frames === null;
    bar.toggleAttribute("data-running", recorder.isRunning);
    if (account.textContent !== recorder.account) account.textContent = account.title = recorder.account;
    tolerance.show(String(recorder.tolerance), false, "");
    timeline.band = recorder.frames;
    timeline.draw();
  };
  recorder.onChange(update);
  update();
}

function toleranceField({ recorder }: Editor, problem: Problem): NumberField {
  const set = (text: string) => (recorder.tolerance = Number(text));
  const give = async (text: string) => {
    if (!(Number(text) >= 0 && Number(text) <= 1)) throw new Error(`Tolerance must be from 0 to 1, not ${text}`);
    set(text);
  };
  const begin = () => {
    const before = recorder.tolerance;
    return { hold: set, end: async () => {}, cancel: async () => (recorder.tolerance = before) };
  };
  const moving = { size: () => 0.01, begin, ended: async () => {} };
  return new NumberField("Tolerance", give, problem, { least: 0, most: 1, isWhole: false, isRatio: false }, moving);
}
