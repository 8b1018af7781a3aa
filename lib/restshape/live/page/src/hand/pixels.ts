// Where on the canvas an event is. `offsetX` of an event has the browser lay the page out first, with each move of the hand.

import type { Scene } from "../draw/scene";

export function pixelsOf(scene: Scene, event: MouseEvent): { x: number; y: number } {
  return { x: event.clientX - scene.left, y: event.clientY - scene.top };
}
