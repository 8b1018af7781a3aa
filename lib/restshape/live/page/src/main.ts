// The page: the session's state, what draws it, and what drives it.

import { App, type Link } from "./app";
import { Connection } from "./connection";
import { meansOf } from "./draw/drawer";
import { Scene } from "./draw/scene";
import { frameOf } from "./frames";
import { joinHand } from "./hand/hand";
import { showHead } from "./head";
import { Latency } from "./latency";
import { Painter } from "./panels/painter";
import { showPanels } from "./panels/panels";
import { showSheet } from "./sheet";

const painter = new Painter();
const app: App = new App((asked) => latency.sent(connection.send(asked)));
const latency = new Latency(app);
const connection = new Connection({
  message: (message) => app.hear(message),
  frame: (header, bytes, base) => app.tell("frame", frameOf(header, bytes, base)),
  connected: linked,
});
showHead(app, painter);
showSheet();
show();

function show(): void {
  const canvas = document.getElementById("canvas") as HTMLCanvasElement;
  const means = meansOf();
  if (!means) {
    sayUnable("This browser has no WebGL 2, with which the page draws. Switch hardware acceleration on, or open the address in "
      + "a current Firefox, Chrome, Edge or Safari. The panels work without it.");
    const nothing = (): void => undefined;
    showPanels(app, { pick: () => Promise.resolve(null), where: () => null, shape: () => null, setLines: nothing, setArrows: nothing, setWords: nothing }, painter);
    return;
  }
  const scene = new Scene(app, canvas, document.getElementById("labels")!, document.getElementById("bar")!, painter, means);
  showPanels(app, joinHand(app, scene), painter);
}

/** Says in place of the picture why there is none. */
function sayUnable(why: string): void {
  const unable = document.getElementById("unable")!;
  unable.textContent = why;
  unable.hidden = false;
}

function linked(open: boolean, why?: "elsewhere" | "ended"): void {
  const link: Link = open ? "open" : why ? why : app.welcome ? "lost" : "connecting";
  app.tell("link", link);
  if (link === "ended" && !app.frame) sayUnable("The session has ended before its first frame. The command that began it says why.");
}
