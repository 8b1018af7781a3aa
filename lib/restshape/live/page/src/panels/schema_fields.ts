// What a form asks for, read from the JSON schema of an event.

/** How a key is asked for. A "point" has `least` to `most` numbers; "points" is a list of those. */
export type FieldKind = "name" | "key" | "text" | "quantity" | "number" | "whole" | "choice" | "yes" | "point" | "points" | "pins" | "any";

export interface FieldShape {
  name: string;
  kind: FieldKind;
  required: boolean;
  help: string;
  choices: string[];
  otherwise: string;                    // the value where it is left out, as text; empty: none
  low: number | null;
  high: number | null;
  least: number;                        // how many: of numbers in a point
  most: number;
  few: number;                          // least number of points in a list
}

type Schema = { [key: string]: unknown };
const LEFT_OUT = new Set(["do", "t", "note", "gesture"]);

/** The keys of an event, required ones first, without its kind, time and note. */
export function fieldsOf(event: object): FieldShape[] {
  const schema = event as Schema;
  const required = new Set((schema["required"] as string[] | undefined) ?? []);
  const properties = (schema["properties"] as Record<string, Schema> | undefined) ?? {};
  return Object.entries(properties)
    .filter(([name]) => !LEFT_OUT.has(name))
    .map(([name, property]) => field(name, property, required.has(name), schema))
    .sort((one, other) => Number(other.required) - Number(one.required));
}

/** The first sentence that says what an event does. */
export function eventText(event: object): string {
  const text = (event as Schema)["description"];
  return typeof text === "string" ? text.split("\n\n")[0]!.replaceAll("``", "").replaceAll("\n", " ") : "";
}

/** What a quantity may look like, as its schema says: "30 deg" of an angle; else a length. */
export function exampleOf({ help }: FieldShape): string {
  return /text such as (.+)$/.exec(help)?.[1] ?? "0.01 or 10 mm";
}

/** Whether its form needs nothing typed. */
export function isPlain(event: object): boolean {
  return fieldsOf(event).length === 0;
}

function field(name: string, property: Schema, required: boolean, root: Schema): FieldShape {
  const options = alternatives(property, root);
  const main = options[0] ?? {};
  const shape: FieldShape = {
    name, kind: "any", required, help: String(property["description"] ?? "").replaceAll("``", ""), choices: [],
    otherwise: defaultText(property["default"]), low: bound(main, "minimum", "exclusiveMinimum"),
    high: bound(main, "maximum", "exclusiveMaximum"), least: 0, most: 0, few: 0,
  };
  return { ...shape, ...kindOf(name, options, root) };
}

function kindOf(name: string, options: Schema[], root: Schema): Partial<FieldShape> {
  const choices = options.flatMap((one) => (one["enum"] as string[] | undefined) ?? ("const" in one ? [String(one["const"])] : []));
  if (choices.length) return { kind: "choice", choices };
  const types = new Set(options.map((one) => one["type"]));
  const array = options.find((one) => one["type"] === "array");
  if (array) return listKind(array, root);
  if (types.has("boolean")) return { kind: "yes" };
  if (types.has("number") || types.has("integer")) {
    return { kind: types.has("string") ? "quantity" : types.has("integer") ? "whole" : "number" };
  }
  if (types.size !== 1 || !types.has("string")) return { kind: "any" };
  return { kind: name === "on" || name === "edge" ? "name" : name === "key" ? "key" : "text" };
}

/** Of an array: a point, a list of points, or names and points that pin a curve. */
function listKind(array: Schema, root: Schema): Partial<FieldShape> {
  const each = (array["prefixItems"] as Schema[] | undefined) ?? (array["items"] ? [array["items"] as Schema] : []);
  const inner = each.flatMap((one) => alternatives(one, root));
  const list = inner.find((one) => one["type"] === "array");
  const least = Number(array["minItems"] ?? 0), most = Number(array["maxItems"] ?? Infinity);
  if (!list) return Number.isFinite(most) && inner.length ? { kind: "point", least, most } : { kind: "any" };
  const point = listKind(list, root);
  if (point.kind !== "point") return { kind: "any" };
  const pins = inner.some((one) => one["type"] === "string");
  return { kind: pins ? "pins" : "points", least: point.least!, most: point.most!, few: least };
}

/** What a value may be, without null: references and unions resolved. */
function alternatives(schema: Schema, root: Schema): Schema[] {
  const reference = schema["$ref"];
  if (typeof reference === "string") {
    const found = ((root["$defs"] ?? {}) as Record<string, Schema>)[reference.split("/").at(-1)!];
    return found ? alternatives(found, root) : [];
  }
  const union = (schema["anyOf"] ?? schema["oneOf"]) as Schema[] | undefined;
  if (union) return union.flatMap((one) => alternatives(one, root));
  return schema["type"] === "null" ? [] : [schema];
}

function bound(schema: Schema, open: string, closed: string): number | null {
  const value = schema[open] ?? schema[closed];
  return typeof value === "number" ? value : null;
}

function defaultText(value: unknown): string {
  if (value === null || value === undefined) return "";
  return typeof value === "string" ? value : JSON.stringify(value);
}
