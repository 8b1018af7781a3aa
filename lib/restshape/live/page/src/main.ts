// The page: the session's state, what draws it, and what drives it.

import { App, type Link } from "./app";
import { Connection } from "./connection";
import { Scene } from "./draw/scene";
import { frameOf } from "./frames";
import { showHead } from "./head";
import { showSheet } from "./sheet";

const app: App = new App((asked) => connection.send(asked));

const canvas = document.getElementById("canvas") as HTMLCanvasElement;
showHead(app);
showSheet();
const scene = new Scene(app, canvas, document.getElementById("labels")!, document.getElementById("bar")!);

function linked(open: boolean): void {
  const link: Link = open ? "open" : app.welcome ? "lost" : "connecting";
  app.tell("link", link);
}

const connection = new Connection({
  message: (message) => app.hear(message),
  frame: (header, bytes, base) => app.tell("frame", frameOf(header, bytes, base)),
  connected: linked,
});
