// The player of a recorded script: play, pause, step, scrub, take over.

import type { App } from "../app";
import { button, ChangingText, element } from "./element";

const SPEEDS = [0.25, 0.5, 1, 2, 4];

export function showPlayer(app: App): HTMLElement {
  const state = { playing: false, frame: 0, frames: 0 };
  const text = new ChangingText();
  const speed = element("select", { "aria-label": "speed" }, ...SPEEDS.map((one) => element("option", { value: one }, `${one} ×`)));
  speed.value = "1";
  const play = button("Play", "play or pause (space)", () => toggle());
  const seek = (frame: number) => app.send({ type: "seek", frame: Math.min(Math.max(frame, 0), state.frames - 1) });
  const scrub = element("input", { type: "range", min: 0, max: 0, step: 1, value: 0, "aria-label": "frame" });
  let scrubbing = false;
  const toggle = () => app.send(state.playing ? { type: "pause" } : { type: "play", speed: Number(speed.value) });
  scrub.addEventListener("input", () => { scrubbing = true; seek(Number(scrub.value)); });
  scrub.addEventListener("change", () => { scrubbing = false; });
  speed.addEventListener("change", () => { if (state.playing) app.send({ type: "play", speed: Number(speed.value) }); });
  const body = element("div", { class: "player", hidden: true },
    play, button("◂", "one frame back (,)", () => seek(state.frame - 1)), button("▸", "one frame on (.)", () => seek(state.frame + 1)),
    scrub, element("span", { class: "place" }, text.node), speed,
    button("Take over", "the hand goes on from this frame; what comes after it is dropped", () => app.send({ type: "take" })));
  const show = (change: Partial<typeof state>) => {
    Object.assign(state, change);
    const word = state.playing ? "Pause" : "Play";
    if (play.textContent !== word) play.textContent = word;
    scrub.max = String(Math.max(state.frames - 1, 0));
    if (!scrubbing) scrub.value = String(state.frame);
    text.set(`frame ${state.frame} of ${Math.max(state.frames - 1, 0)}`);
  };
  app.on("welcome", ({ player, frames }) => {
    body.hidden = !player;
    show({ playing: false, frame: 0, frames });
  });
  app.on("player", ({ playing, frame, frames }) => show({ playing, frame, frames }));
  addEventListener("keydown", (event) => {
    const at = event.target;
    // A button has its own use of the space key, and none of the others.
    const takers = event.key === " " ? "input, select, button, textarea, summary, dialog" : "input:not([type=range], [type=checkbox], [type=radio]), select, textarea, dialog";
    const elsewhere = at instanceof HTMLElement && at.closest(takers);
    if (body.hidden || elsewhere || event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === " ") toggle();
    else if (event.key === ",") seek(state.frame - 1);
    else if (event.key === ".") seek(state.frame + 1);
    else return;
    event.preventDefault();
  });
  return body;
}
