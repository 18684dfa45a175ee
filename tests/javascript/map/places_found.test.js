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

test("a search finds bases and zones, these with their box, and asks for bases once", async (context) => {
  const asked = [];
  context.mock.method(globalThis, "fetch", async (address) => {
    asked.push(String(address).split("?")[0]);
    const body = String(address).includes("/bases")
      ? { results: [{ name: "Gate west", position: [10, 56] }] }
      : {
          features: [
            {
              geometry: {
                coordinates: [
                  [
                    [
                      [9, 55],
                      [9, 57],
                      [11, 56],
                    ],
                  ],
                ],
              },
              properties: { name: "West" },
            },
          ],
        };
    return new Response(JSON.stringify(body), { headers: { "Content-Type": "application/json" } });
  });
  assert.deepEqual(
    (await placesFound("gate")).map(({ label, detail, position, box }) => [label, detail, position, box]),
    [
      ["Gate west", "Base", [10, 56], undefined],
      ["West", "No-fly zone", undefined, [9, 55, 11, 57]],
    ],
  );
  await placesFound("west");
  assert.equal(asked.filter((address) => address.endsWith("/bases")).length, 1);
});
