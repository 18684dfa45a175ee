import assert from "node:assert/strict";
import { test } from "node:test";
import { placesFound, toldApart } from "../../../static/js/map/places_found.js";

test("bridges that are called alike are told apart by where they are", () => {
  const bridge = (words, centre) => ({ words, detail: "carries a road", centre });
  const [first, second, third] = toldApart([
    bridge("High Street", [10, 56]),
    bridge("High Street", [10.1, 56]),
    bridge("Low Street", [10, 56]),
  ]);
  assert.notEqual(first.detail, second.detail);
  assert.match(first.detail, /^carries a road · .*56/);
  assert.equal(third.detail, "carries a road");
});

test("a search finds bases by name, and asks for them once", async (context) => {
  const asked = [];
  context.mock.method(globalThis, "fetch", async (address) => {
    asked.push(String(address).split("?")[0]);
    const body = String(address).includes("/bases")
      ? { results: [{ name: "Gate west", position: [10, 56] }] }
      : { features: [] };
    return new Response(JSON.stringify(body), { headers: { "Content-Type": "application/json" } });
  });
  assert.deepEqual(
    (await placesFound("gate")).map(({ label, detail, position }) => [label, detail, position]),
    [["Gate west", "Base", [10, 56]]],
  );
  await placesFound("west");
  assert.equal(asked.filter((address) => address.endsWith("/bases")).length, 1);
});
