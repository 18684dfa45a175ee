/** Schemas of the OpenAPI document: references resolved, types in short, and values that fit. */

/**
 * A schema of OpenAPI 3.0, as far as the document uses it.
 *
 * @typedef {object} Schema
 * @property {string} [$ref]
 * @property {Schema[]} [allOf]
 * @property {Schema[]} [oneOf]
 * @property {Schema[]} [anyOf]
 * @property {string} [type]
 * @property {string} [format]
 * @property {string} [description]
 * @property {string} [pattern]
 * @property {unknown[]} [enum]
 * @property {unknown} [example]
 * @property {unknown} [default]
 * @property {boolean} [nullable]
 * @property {boolean} [readOnly]
 * @property {boolean} [deprecated]
 * @property {Schema} [items]
 * @property {Record<string, Schema>} [properties]
 * @property {string[]} [required]
 * @property {boolean | Schema} [additionalProperties]
 * @property {number} [minimum]
 * @property {number} [maximum]
 * @property {boolean} [exclusiveMinimum]
 * @property {number} [minLength]
 * @property {number} [maxLength]
 * @property {number} [minItems]
 * @property {number} [maxItems]
 */

/** @typedef {{ name: string, in: string, required?: boolean, description?: string, schema: Schema, deprecated?: boolean }} Parameter */
/** @typedef {{ schema: Schema, examples?: Record<string, { value: unknown }> }} Content */
/** @typedef {{ description: string, content?: Record<string, Content>, headers?: Record<string, { $ref: string }> }} Answer */
/**
 * @typedef {object} Operation
 * @property {string} operationId
 * @property {string} summary
 * @property {string} [description]
 * @property {boolean} [deprecated]
 * @property {Parameter[]} [parameters]
 * @property {{ content: Record<string, Content>, required?: boolean }} [requestBody]
 * @property {Record<string, Answer>} responses
 * @property {Record<string, string[]>[]} [security]
 */
/** @typedef {{ schemas: Record<string, Schema>, headers: Record<string, { description: string }> }} Components */
/** @typedef {{ paths: Record<string, Record<string, Operation>>, components: Components }} Api */

const UUID = "00000000-0000-4000-8000-000000000000";
const HASH = "0".repeat(64);
/** @type {Record<string, string>} */
const OF_FORMAT = {
  "date-time": "2027-05-04T08:00:00Z",
  date: "2027-05-04",
  time: "08:00:00",
  uuid: UUID,
  email: "name@example.org",
  uri: "https://example.org/",
};
const MAX_SHOWN_LIMIT = 999_999_999; // of ids
/** In the order in which they are tried where a pattern is stated. */
const OF_PATTERNS = ["text", "1", "a", HASH, "00", "Europe/Berlin"];

/** The name of a referenced component. @param {string} reference */
export const nameOf = (reference) => reference.slice(reference.lastIndexOf("/") + 1);

/** A schema with what it refers to and is made of, in one. @param {Api} api @param {Schema} schema @returns {Schema} */
export function resolved(api, schema) {
  const { $ref, allOf = [], ...own } = schema;
  const parts = [...($ref ? [api.components.schemas[nameOf($ref)]] : []), ...allOf];
  return Object.assign({}, ...parts.map((part) => resolved(api, part)), own);
}

/** The kinds of a schema with several shapes; else none. @param {Schema} schema @returns {Schema[]} */
export const shapesOf = ({ oneOf, anyOf }) => oneOf ?? anyOf ?? [];

/** A type in short, in the words of JSON Schema: "array of integer, 1…20 items". @param {Api} api @param {Schema} schema @returns {string} */
export function typeText(api, schema) {
  const whole = resolved(api, schema);
  const several = shapesOf(whole);
  const name = several.length
    ? [...new Set(several.map((one) => typeText(api, one)))].join(" | ")
    : plainType(api, whole);
  return [name, ...limitsOf(whole)].join(", ") + (whole.nullable ? " | null" : "");
}

/** @param {Api} api @param {Schema} schema */
function plainType(api, schema) {
  if (schema.type === "array") return `array of ${schema.items ? typeText(api, schema.items) : "any"}`;
  const type = schema.type ?? "any";
  return schema.format && !["double", "int64"].includes(schema.format) ? `${type} (${schema.format})` : type;
}

/** @param {Schema} schema @returns {string[]} */
function limitsOf({ minimum, maximum, exclusiveMinimum, minLength, maxLength, minItems, maxItems }) {
  /** @param {number | undefined} least @param {number | undefined} most @param {string} unit @param {string} [sign] */
  const range = (least, most, unit, sign = "≥") => {
    const isBounded = most !== undefined && most < MAX_SHOWN_LIMIT;
    if (least === undefined) return isBounded ? [`≤ ${most}${unit}`] : [];
    if (!isBounded) return [`${sign} ${least}${unit}`];
    if (least === most) return [`${least}${unit}`];
    return [sign === ">" ? `> ${least}, ≤ ${most}${unit}` : `${least}…${most}${unit}`];
  };
  return [
    ...range(minimum, maximum, "", exclusiveMinimum ? ">" : "≥"),
    ...range(minLength, maxLength, " chars"),
    ...range(minItems, maxItems, " items"),
  ];
}

/**
 * The values that a schema allows, with what the description says of each; and the description without this list.
 *
 * @param {Schema} schema
 * @returns {{ words: string, values: { value: string, words: string }[] }}
 */
export function describedValues(schema) {
  const lines = (schema.description ?? "").split("\n");
  const listed = new Map(
    lines.flatMap((line) => [/^\* `(.*)` - (.*)$/.exec(line)]).map((found) => [found?.[1], found?.[2]]),
  );
  const words = lines
    .filter((line) => !line.startsWith("* `"))
    .join("\n")
    .trim();
  const values = (schema.enum ?? []).filter((value) => value !== null && value !== "").map(String);
  return { words, values: values.map((value) => ({ value, words: listed.get(value) ?? "" })) };
}

/**
 * A value that a schema takes: what is required, and one field where nothing is.
 *
 * @param {Api} api
 * @param {Schema} schema
 * @param {string} [name] of the field
 * @returns {unknown}
 */
export function exampleOf(api, schema, name = "text") {
  const whole = resolved(api, schema);
  if (whole.example !== undefined) return whole.example;
  if (whole.default !== undefined && whole.default !== null) return whole.default;
  const [value] = (whole.enum ?? []).filter((one) => one !== null && one !== "");
  if (value !== undefined) return value;
  const [shape] = shapesOf(whole);
  if (shape) return exampleOf(api, shape, name);
  if (whole.type === "object") return exampleObject(api, whole);
  if (whole.type === "array") return exampleArray(api, whole, name);
  if (whole.type === "boolean") return true;
  if (whole.type === "integer" || whole.type === "number") return exampleNumber(whole);
  return exampleText(whole, name);
}

/** @param {Api} api @param {Schema} schema */
function exampleObject(api, { properties = {}, required = [] }) {
  const names = Object.keys(properties).filter((name) => required.includes(name));
  const [first] = Object.keys(properties);
  const chosen = names.length || !first ? names : [first];
  return Object.fromEntries(chosen.map((name) => [name, exampleOf(api, properties[name], name)]));
}

/** @param {Api} api @param {Schema} schema @param {string} name */
function exampleArray(api, { items = {}, minItems = 0 }, name) {
  return Array.from({ length: Math.max(1, minItems) }, () => exampleOf(api, items, name));
}

/** @param {Schema} schema */
function exampleNumber({ minimum = 1, maximum = Number.POSITIVE_INFINITY, exclusiveMinimum = false }) {
  return Math.min(Math.max(0, exclusiveMinimum ? minimum + 1 : minimum), maximum);
}

/** @param {Schema} schema @param {string} name */
function exampleText({ format = "", pattern, minLength = 0, maxLength = 1_000 }, name) {
  if (OF_FORMAT[format]) return OF_FORMAT[format];
  const shape = pattern === undefined ? null : new RegExp(pattern, "u");
  const fits = [name, ...OF_PATTERNS].find((text) => text.length <= maxLength && (shape?.test(text) ?? true)) ?? name;
  return fits.padEnd(minLength, "x");
}
