/** Offline copies: which addresses make one, and what of an approval is shown. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { isKept, placesOf, tilesOf, wholeOf } from "../../../static/js/offline/addresses.js";
import { fencesOf, rallyPointsOf } from "../../../static/js/offline/briefing.js";

const CORNER = [9.52, 47.14];

test("a copy is kept of a mission that is approved and not over", () => {
  const states = ["draft", "planned", "approved", "dispatched", "active", "completed", "aborted", "failed"];
  assert.deepEqual(
    states.filter((state) => isKept({ state })),
    ["approved", "dispatched", "active"],
  );
});

test("pages, mission, approval and fleet are kept together", () => {
  assert.deepEqual(wholeOf("m", ["/api/v1/uavs?limit=100"]).slice(0, 4), [
    "/missions/m",
    "/missions/m/fly",
    "/api/v1/missions/m",
    "/api/v1/missions/m/approval",
  ]);
});

test("a small mission has tiles down to zoom 14, the one that holds it at each zoom", () => {
  const tiles = tilesOf([CORNER]);
  assert.ok(tiles.includes("/api/v1/tiles/7/67/44")); // worked by hand: (9.52 + 180) / 360 * 128 = 67.4
  for (let zoom = 7; zoom <= 14; zoom += 1) assert.ok(tiles.some((tile) => tile.startsWith(`/api/v1/tiles/${zoom}/`)));
});

test("a mission over a country has fewer zooms, not thousands of tiles", () => {
  const tiles = tilesOf([CORNER, [14.5, 51.1]]);
  assert.ok(tiles.length > 0 && tiles.length <= 240);
  assert.ok(!tiles.some((tile) => tile.startsWith("/api/v1/tiles/14/")));
});

test("no places, no tiles", () => assert.deepEqual(tilesOf([]), []));

test("the map has to show waypoints, targets, starts and rally points", () => {
  const mission = {
    plan: { routes: [{ waypoints: [{ position: [1, 1] }] }] },
    targets: [{ position: [2, 2] }, { position: null }],
    uavs: [{ position: [3, 3] }],
    lost_link: { behaviour: "return", rally_points: [[4, 4]] },
  };
  assert.deepEqual(
    placesOf(mission).map(([longitude]) => longitude),
    [1, 2, 3, 4],
  );
});

test("fences are read from the items that UAVs are given, each once, as closed rings", () => {
  const corner = (longitude_e7, latitude_e7) => [5002, 5, 3, 0, 0, 0, longitude_e7, latitude_e7, 0, null];
  const fence = [corner(95_200_000, 471_400_000), corner(95_300_000, 471_400_000), corner(95_300_000, 471_500_000)];
  const other = [corner(96_000_000, 471_400_000), corner(96_100_000, 471_400_000), corner(96_100_000, 471_500_000)];
  const routes = [
    { uav: 1, place: 0, flights: [{ items: { fence: [...fence, ...other] } }] },
    { uav: 2, place: 1, flights: [{ items: { fence } }, { items: null }] },
  ];
  const rings = fencesOf({ document: { zones: [], routes } });
  assert.equal(rings.length, 2);
  assert.deepEqual(rings[0], [
    [9.52, 47.14],
    [9.53, 47.14],
    [9.53, 47.15],
    [9.52, 47.14],
  ]);
  assert.deepEqual(fencesOf(null), []);
});

test("UAVs that fly on without a link have no rally points", () => {
  assert.deepEqual(rallyPointsOf({ lost_link: { behaviour: "go_on", rally_points: [CORNER] } }), []);
  assert.deepEqual(rallyPointsOf({ lost_link: { behaviour: "hold", rally_points: [CORNER] } }), [CORNER]);
});
