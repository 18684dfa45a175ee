import assert from "node:assert/strict";
import { test } from "node:test";
import { describedValues, exampleOf, typeText } from "../../../static/js/api_docs/schema.js";

const api = /** @type {any} */ ({
  paths: {},
  components: {
    headers: {},
    schemas: {
      Kind: { type: "string", enum: ["tower", "line"] },
      Node: {
        type: "object",
        required: ["next", "kind"],
        properties: { next: { $ref: "#/components/schemas/Kind" }, kind: {} },
      },
    },
  },
});

test("a type is told in short, with its limits", () => {
  assert.equal(typeText(api, { type: "integer", minimum: 1, maximum: 20, nullable: true }), "integer, 1…20 | null");
  assert.equal(typeText(api, { type: "number", minimum: 0, exclusiveMinimum: true, maximum: 5 }), "number, > 0, ≤ 5");
  assert.equal(typeText(api, { type: "number", minimum: 0, exclusiveMinimum: true }), "number, > 0");
  assert.equal(typeText(api, { type: "integer", minimum: 1, maximum: 2 ** 63 }), "integer, ≥ 1");
  assert.equal(
    typeText(api, { type: "array", items: { type: "number" }, minItems: 2, maxItems: 2 }),
    "array of number, 2 items",
  );
  assert.equal(typeText(api, { type: "string", format: "uuid", maxLength: 36 }), "string (uuid), ≤ 36 chars");
  assert.equal(
    typeText(api, { type: "array", items: { $ref: "#/components/schemas/Node" }, minItems: 1 }),
    "array of object, ≥ 1 items",
  );
  assert.equal(typeText(api, { oneOf: [{ type: "string" }, { type: "number" }] }), "string | number");
});

test("values are listed with what the description says of each, and the description is without the list", () => {
  const schema = {
    enum: ["tower", "line", "", null],
    description: "what it is\n\n* `tower` - Tower or pole\n* `line` - Power line",
  };
  assert.deepEqual(describedValues(schema), {
    words: "what it is",
    values: [
      { value: "tower", words: "Tower or pole" },
      { value: "line", words: "Power line" },
    ],
  });
});

test("an example has the required fields, and keeps limits and patterns", () => {
  assert.deepEqual(exampleOf(api, { $ref: "#/components/schemas/Node" }), { next: "tower", kind: "kind" });
  assert.equal(exampleOf(api, { type: "integer", minimum: 5 }), 5);
  assert.equal(exampleOf(api, { type: "integer", minimum: 0 }), 0);
  assert.equal(exampleOf(api, { type: "string", pattern: "^[0-9a-f]{64}$" }), "0".repeat(64));
  assert.deepEqual(exampleOf(api, { type: "array", items: { type: "string" }, minItems: 2 }, "name"), ["name", "name"]);
});
