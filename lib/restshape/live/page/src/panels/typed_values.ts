// What is typed into a form, as values of an event; a TypedError says what is wrong with it.

import type { FieldShape } from "./schema_fields";

export class TypedError extends Error {}

const NUMBER = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;

/** A number, or text with its unit as it is: "12 mm"; null: nothing is typed. */
export function quantityOf(text: string): number | string | null {
  const typed = text.trim().replace("−", "-");
  if (!typed) return null;
  return NUMBER.test(typed) ? Number(typed) : typed;
}

/** The value of a key; undefined: it is left out. Throws TypedError. */
export function valueOf(field: FieldShape, text: string): unknown {
  const typed = text.trim();
  if (!typed) {
    if (field.required) throw new TypedError(`${field.name} is needed`);
    return undefined;
  }
  switch (field.kind) {
    case "number": case "whole": return numberOf(field, typed);
    case "quantity": return quantityOf(typed);
    case "yes": return typed === "true";
    case "point": return pointOf(field, typed);
    case "points": return pointsOf(field, typed);
    case "pins": return typed.split(";").map((pin) => (/[,\d]/.test(pin) && pin.includes(",") ? pointOf(field, pin) : pin.trim()));
    case "any": return anyOf(typed);
    default: return typed;
  }
}

function numberOf(field: FieldShape, typed: string): number {
  const value = quantityOf(typed);
  if (typeof value !== "number") throw new TypedError(`${field.name} is a number, without a unit`);
  if (field.kind === "whole" && !Number.isInteger(value)) throw new TypedError(`${field.name} is a whole number`);
  return value;
}

/** "0.3, 20 mm" as its numbers. */
function pointOf(field: FieldShape, typed: string): (number | string)[] {
  const parts = typed.replace(/^\[|\]$/g, "").split(",").map(quantityOf).filter((part) => part !== null);
  const { least, most } = field;
  if (parts.length < least || parts.length > most) {
    throw new TypedError(`${field.name} has ${least === most ? least : `${least} or ${most}`} numbers with commas between`);
  }
  return parts;
}

function pointsOf(field: FieldShape, typed: string): (number | string)[][] {
  const points = typed.split(";").filter((part) => part.trim()).map((part) => pointOf(field, part.trim()));
  if (points.length < field.few) throw new TypedError(`${field.name} has ${field.few} points or more, with semicolons between`);
  return points;
}

/** A number, JSON, or else text. */
function anyOf(typed: string): unknown {
  const value = quantityOf(typed);
  if (typeof value === "number") return value;
  try { return JSON.parse(typed); } catch { return typed; }
}

/** A place as it is typed into forms, its numbers to a hundredth of a millimetre. */
export function pointText(place: number[], most: number): string {
  return place.slice(0, most).map((value) => String(Number(value.toFixed(5)) + 0)).join(", ");
}
