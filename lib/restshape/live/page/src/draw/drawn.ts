// What an object of three.js draws: each drawing finds from the object what it needs.

import type { Object3D } from "three";

/** What fills its buffers of the graphics card only when a graphics card draws it. */
export interface Drawn { ready(): void; }

const drawings = new WeakMap<Object3D, Drawn>();

export function drawnBy(object: Object3D, by: Drawn): void { drawings.set(object, by); }

export function whatDraws(object: Object3D): Drawn | undefined { return drawings.get(object); }
