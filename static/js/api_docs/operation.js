/** What an operation takes and answers, with an example. Words of the document are English in each language of the page. */

import { h, icon } from "../dom.js";
import { t } from "../text.js";
import { codeSample } from "./code_samples.js";
import { asCurl, asPython, exampleRequest } from "./examples.js";
import { describedValues, nameOf, resolved, shapesOf, typeText } from "./schema.js";

/** @import { Api, Answer, Operation, Parameter, Schema } from "./schema.js" */
/** @import { Child } from "../dom.js" */

/**
 * Returns the details of an operation.
 *
 * @param {Api} api
 * @param {string} path
 * @param {string} method
 */
export function operationDetails(api, path, method) {
  const operation = api.paths[path][method];
  const ways = (operation.security ?? []).flatMap(Object.keys);
  const body = Object.entries(operation.requestBody?.content ?? {})[0];
  return h(
    "div",
    { class: "api-details" },
    h(
      "div",
      { class: "api-facts" },
      operation.deprecated && h("p", { class: "notice warning" }, icon("triangle-alert"), t("Deprecated")),
      operation.description && h("p", { lang: "en" }, inline(operation.description)),
      ways.includes("uavToken") && h("p", { class: "caption" }, t("Requires the link token of a UAV.")),
      !takesToken(ways) && h("p", { class: "caption" }, t("Only in a signed-in browser: tokens are refused.")),
      part(t("Parameters"), parameterList(api, operation.parameters ?? [])),
      body && part(t("Request body"), bodyOf(api, body[0], body[1].schema)),
      part(t("Responses"), answers(api, operation)),
    ),
    takesToken(ways) && example(api, path, method),
  );
}

/** Whether a program may call it. @param {string[]} ways to authenticate */
const takesToken = (ways) => ways.includes("bearerToken") || ways.includes("uavToken");

/** @param {Api} api @param {string} path @param {string} method */
function example(api, path, method) {
  const request = exampleRequest(api, path, method);
  const texts = { curl: asCurl(location.origin, request), python: asPython(location.origin, request) };
  return h("div", { class: "api-example" }, h("h4", {}, t("Example")), codeSample(texts));
}

/** @param {string} title @param {Child} content nothing where there is none */
const part = (title, content) => content && h("section", {}, h("h4", {}, title), content);

/** Text with what is in backticks as code. @param {string} text @returns {Child[]} */
function inline(text) {
  return text.split(/`([^`]+)`/).map((piece, place) => (place % 2 ? h("code", {}, piece) : piece));
}

/** @param {Api} api @param {Parameter[]} parameters */
function parameterList(api, parameters) {
  if (!parameters.length) return null;
  return h(
    "ul",
    { class: "api-fields" },
    parameters.map((one) => {
      const schema = { ...one.schema, description: one.description ?? one.schema.description };
      return field(api, { name: one.name, schema, isRequired: one.required === true, place: one.in }, true);
    }),
  );
}

/** @param {Api} api @param {string} mediaType @param {Schema} schema */
function bodyOf(api, mediaType, schema) {
  const inside = fieldsOf(api, schema, true);
  return [h("p", { class: "caption" }, mediaType, inside ? "" : ` · ${typeText(api, schema)}`), inside];
}

/**
 * A field or parameter, with the fields inside it as soon as they are opened: schemas may contain themselves.
 *
 * @param {Api} api
 * @param {{ name: string, schema: Schema, isRequired: boolean, place?: string }} of
 * @param {boolean} marksRequired as in requests: in responses nearly every field is there
 */
function field(api, { name, schema, isRequired, place = "" }, marksRequired) {
  const whole = resolved(api, schema);
  const { words, values } = describedValues(whole);
  return h(
    "li",
    {},
    h(
      "div",
      { class: "api-field" },
      h("code", { class: "api-name" }, name),
      h("span", { class: "api-type", lang: "en" }, place ? `${place} · ` : "", typeText(api, schema)),
      marksRequired && isRequired && h("span", { class: "chip draft" }, t("required")),
      whole.deprecated && h("span", { class: "chip aborted" }, t("deprecated")),
    ),
    words && h("p", { lang: "en" }, inline(words)),
    values.length > 0 && h("p", { class: "api-values", lang: "en" }, values.map(valueText)),
    whole.default !== undefined &&
      h("p", { class: "caption" }, t("Default: {value}", { value: JSON.stringify(whole.default) })),
    opened(api, whole, marksRequired),
  );
}

/** @param {{ value: string, words: string }} of @param {number} place @returns {Child[]} */
function valueText({ value, words }, place) {
  const says = words && words.toLowerCase() !== value.toLowerCase() ? ` ${words}` : "";
  return [place ? " · " : "", h("code", {}, value), says];
}

/** The fields of an object, or of the objects of a list, behind a line that opens them. @param {Api} api @param {Schema} schema @param {boolean} marksRequired */
function opened(api, schema, marksRequired) {
  const inner = schema.type === "array" && schema.items ? resolved(api, schema.items) : schema;
  const shapes = shapesOf(inner).filter((one) => hasFields(resolved(api, one)));
  if (!hasFields(inner) && !shapes.length) return null;
  const details = h("details", { class: "api-inside" }, h("summary", {}, t("Fields")));
  details.addEventListener("toggle", () => details.append(...listed(fieldsOf(api, inner, marksRequired))), {
    once: true,
  });
  return details;
}

/** @param {Child} child @returns {Node[]} */
const listed = (child) => /** @type {Node[]} */ ([child].flat().filter(Boolean));

/** @param {Schema} schema */
const hasFields = ({ properties }) => properties !== undefined && Object.keys(properties).length > 0;

/** @param {Api} api @param {Schema} schema @param {boolean} marksRequired @returns {Child} */
function fieldsOf(api, schema, marksRequired) {
  const whole = resolved(api, schema);
  const inner = whole.type === "array" && whole.items ? resolved(api, whole.items) : whole;
  const shapes = shapesOf(inner);
  if (shapes.length)
    return shapes.flatMap((shape, place) => [
      h(
        "p",
        { class: "caption" },
        t("Variant {number} of {count}", { number: `${place + 1}`, count: `${shapes.length}` }),
      ),
      fieldsOf(api, shape, marksRequired) ?? h("p", { class: "api-type", lang: "en" }, typeText(api, shape)),
    ]);
  if (!hasFields(inner)) return null;
  const { properties = {}, required = [] } = inner;
  return h(
    "ul",
    { class: "api-fields" },
    Object.entries(properties).map(([name, each]) =>
      field(api, { name, schema: each, isRequired: required.includes(name) }, marksRequired),
    ),
  );
}

/** @param {Api} api @param {Operation} operation */
function answers(api, operation) {
  const all = Object.entries(operation.responses).sort();
  const faults = all.filter(([status]) => status >= "400");
  return [
    h(
      "ul",
      { class: "api-fields" },
      all.filter(([status]) => status < "400").map(([status, answer]) => answerRow(api, status, answer)),
    ),
    h(
      "details",
      { class: "api-inside" },
      h("summary", {}, t("Errors"), h("span", { class: "caption" }, ` ${faults.map(([status]) => status).join(", ")}`)),
      h(
        "dl",
        { class: "api-errors" },
        faults.map(([status, { description }]) => [
          h("dt", {}, h("code", {}, status)),
          h("dd", { lang: "en" }, inline(description)),
        ]),
      ),
    ),
  ];
}

/** @param {Api} api @param {string} status @param {Answer} answer */
function answerRow(api, status, { description, content = {}, headers = {} }) {
  const types = Object.keys(content);
  const schema = Object.values(content)[0]?.schema;
  const names = Object.entries(headers).map(([name, { $ref }]) => ({
    name,
    words: api.components.headers[nameOf($ref)].description,
  }));
  return h(
    "li",
    {},
    h(
      "div",
      { class: "api-field" },
      h("code", { class: "api-name" }, status),
      types.length
        ? h("span", { class: "api-type", lang: "en" }, types.join(", "))
        : h("span", { class: "api-type" }, t("no body")),
    ),
    description && h("p", { lang: "en" }, inline(description)),
    names.length > 0 &&
      h(
        "dl",
        { class: "api-errors" },
        names.map(({ name, words }) => [h("dt", {}, h("code", {}, name)), h("dd", { lang: "en" }, inline(words))]),
      ),
    schema && types[0].endsWith("json") && opened(api, resolved(api, schema), false),
  );
}
