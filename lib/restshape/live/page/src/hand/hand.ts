// The person's hand on the picture: by mouse, touch and keys.

import type { App } from "../app";
import type { Scene } from "../draw/scene";
import { Beside } from "./beside";
import { Keys } from "./keys";
import { Pointer } from "./pointer";
import { PageStage } from "./stage";
import { showToolbars } from "./toolbar";
import { Tools } from "./tools";
import { Turning } from "./turning";

/** Joins the hand to the picture; gives what panels may ask of both. */
export function joinHand(app: App, scene: Scene): PageStage {
  const beside = new Beside(app);
  const tools = new Tools(app, scene, beside);
  const pointer = new Pointer(app, scene, tools, beside);
  tools.targets = pointer.targets;
  const turning = new Turning(app, scene, tools, (name) => pointer.targets.find(app.things, name));
  new Keys(app, scene, pointer, tools, turning);
  showToolbars(app, scene, tools, pointer);
  return new PageStage(app, scene, tools, beside, pointer.targets);
}
