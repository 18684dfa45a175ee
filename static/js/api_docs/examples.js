/** A request of an operation, as curl and in Python with requests. Ids are written in capitals: they are yours to fill in. */

import { exampleOf } from "./schema.js";

/** @import { Api, Operation, Parameter } from "./schema.js" */

/**
 * @typedef {object} Request
 * @property {string} method
 * @property {string} path
 * @property {[string, string][]} query
 * @property {[string, string][]} headers without the token
 * @property {string} token the environment variable that holds it
 * @property {unknown} [body] of JSON
 * @property {boolean} isFile whether the body is a file
 * @property {string} returns media type of the answer; empty where there is no body
 */

/**
 * The request with what is required.
 *
 * @param {Api} api
 * @param {string} path
 * @param {string} method
 * @returns {Request}
 */
export function exampleRequest(api, path, method) {
  const operation = api.paths[path][method];
  const required = (operation.parameters ?? []).filter((parameter) => parameter.required);
  const content = Object.entries(operation.requestBody?.content ?? {})[0];
  const isFile = content !== undefined && content[0] !== "application/json";
  return {
    method: method.toUpperCase(),
    path: path.replace(/\{(\w+)\}/g, (_whole, name) => pathValue(required, name)),
    query: required
      .filter((one) => one.in === "query")
      .map((one) => [one.name, String(exampleOf(api, one.schema, one.name))]),
    headers: [
      ...required.filter((one) => one.in === "header").map((one) => headerValue(api, one)),
      .../** @type {[string, string][]} */ (isFile ? [["Content-Type", content[0]]] : []),
    ],
    token: (operation.security ?? []).some((way) => "uavToken" in way) ? "SPANWISE_UAV_TOKEN" : "SPANWISE_TOKEN",
    body: content && !isFile ? exampleBody(api, content[1]) : undefined,
    isFile,
    returns: Object.keys(successOf(operation).content ?? {})[0] ?? "",
  };
}

/** The example that the document has, else one made from the schema. @param {Api} api @param {import("./schema.js").Content} content */
const exampleBody = (api, { schema, examples = {} }) => Object.values(examples)[0]?.value ?? exampleOf(api, schema);

/** The answer where all goes well. @param {Operation} operation */
export function successOf(operation) {
  const status = Object.keys(operation.responses).find((one) => one.startsWith("2"));
  return operation.responses[status ?? Object.keys(operation.responses)[0]];
}

/** @param {Parameter[]} parameters @param {string} name */
function pathValue(parameters, name) {
  const schema = parameters.find((one) => one.in === "path" && one.name === name)?.schema;
  return String(schema?.enum?.[0] ?? name.toUpperCase());
}

/** @param {Api} api @param {Parameter} parameter @returns {[string, string]} */
const headerValue = (api, { name, schema }) => [
  name,
  name === "If-Match" ? '"ETAG"' : String(exampleOf(api, schema, name)),
];

/** @param {string} text */
const inShell = (text) => `'${text.replaceAll("'", "'\\''")}'`;

/** @param {string} server @param {Request} request */
export function asCurl(server, request) {
  const query = new URLSearchParams(request.query).toString();
  const lines = [
    `curl -X ${request.method} ${inShell(`${server}${request.path}${query && `?${query}`}`)}`,
    `-H "Authorization: Bearer $${request.token}"`,
    ...request.headers.map(([name, value]) => `-H ${inShell(`${name}: ${value}`)}`),
  ];
  if (request.body !== undefined)
    lines.push(`-H 'Content-Type: application/json'`, `-d ${inShell(laidOut(request.body, JSON_WORDS))}`);
  if (request.isFile) lines.push("--data-binary @FILE");
  if (isDownload(request)) lines.push("-o FILE");
  return lines.join(" \\\n  ");
}

/** @param {string} server @param {Request} request */
export function asPython(server, request) {
  const headers = [`"Authorization": f"Bearer {os.environ['${request.token}']}"`, ...request.headers.map(pair)];
  const lines = [
    "import os",
    "",
    "import requests",
    "",
    `answer = requests.${request.method.toLowerCase()}(`,
    `    ${inPython(server + request.path)},`,
    `    headers={${headers.length > 1 ? `\n${headers.map((line) => `        ${line},\n`).join("")}    ` : headers[0]}},`,
  ];
  if (request.query.length) lines.push(`    params={${request.query.map(pair).join(", ")}},`);
  if (request.body !== undefined) lines.push(`    json=${inPython(request.body, "    ")},`);
  if (request.isFile) lines.push(`    data=open("FILE", "rb"),`);
  lines.push("    timeout=30,", ")", "answer.raise_for_status()");
  if (isDownload(request)) lines.push(`open("FILE", "wb").write(answer.content)`);
  else if (request.returns) lines.push("print(answer.json())");
  return lines.join("\n");
}

/** @param {Request} request */
const isDownload = ({ returns }) => Boolean(returns) && !returns.endsWith("json");

/** @param {[string, string]} entry */
const pair = ([name, value]) => `${inPython(name)}: ${inPython(value)}`;

/**
 * How a language writes values, and whether a comma stands after the last of several lines.
 *
 * @typedef {{ step: string, lastComma: string, plain: (value: unknown) => string }} Words
 */
/** @type {Words} */
const JSON_WORDS = { step: "  ", lastComma: "", plain: JSON.stringify };
/** @type {Words} */
const PYTHON_WORDS = {
  step: "    ",
  lastComma: ",",
  plain(value) {
    if (value === null) return "None";
    if (typeof value === "boolean") return value ? "True" : "False";
    const hasQuotes = typeof value === "string" && /^[^'\\]*"[^'\\]*$/.test(value);
    return hasQuotes ? `'${value}'` : JSON.stringify(value);
  },
};

/** @param {unknown} value @param {string} [indent] */
const inPython = (value, indent = "") => laidOut(value, PYTHON_WORDS, indent);

/** A value of JSON, in one line where it is short. @param {unknown} value @param {Words} words @param {string} [indent] @returns {string} */
function laidOut(value, words, indent = "") {
  if (value === null || typeof value !== "object") return words.plain(value);
  const [open, close] = Array.isArray(value) ? "[]" : "{}";
  const deeper = indent + words.step;
  const items = Array.isArray(value)
    ? value.map((item) => laidOut(item, words, deeper))
    : Object.entries(value).map(([name, item]) => `${words.plain(name)}: ${laidOut(item, words, deeper)}`);
  const inOneLine = `${open}${items.join(", ")}${close}`;
  if (inOneLine.length < 60 && !inOneLine.includes("\n")) return inOneLine;
  return `${open}\n${deeper}${items.join(`,\n${deeper}`)}${words.lastComma}\n${indent}${close}`;
}
