import assert from "node:assert/strict";
import test from "node:test";

globalThis.document ??= { cookie: "", querySelector: () => null, documentElement: { lang: "en", dataset: {} } };
globalThis.location ??= { hash: "", pathname: "/", protocol: "http:", host: "here" };
const { areaOf, periodOf } = await import("../../../static/js/mission/panels/temporary_zone.js");
const { simplified } = await import("../../../static/js/domain/geodesy.js");

const CORNERS = [
  [9, 50],
  [9.02, 50],
  [9.02, 50.01],
  [9, 50.01],
];
/** A freehand line along the corners, that shakes by less than a metre. */
const drawn = CORNERS.flatMap(([longitude, latitude], corner) => {
  const [to, north] = CORNERS[(corner + 1) % CORNERS.length];
  return Array.from({ length: 25 }, (_, step) => {
    const share = step / 25;
    const shake = step && step % 2 ? 0.000008 : 0;
    return [longitude + (to - longitude) * share + shake, latitude + (north - latitude) * share + shake];
  });
});

test("of a freehand line the corners stay", () => {
  const kept = simplified(drawn, 0.01);
  assert.ok(kept.length <= 8, `${kept.length}`);
  assert.notDeepEqual(simplified([...drawn, drawn[0]], 0.01).at(-1), drawn[0]); // one that ends where it began
  for (const corner of CORNERS) assert.ok(kept.some((place) => place[0] === corner[0] && place[1] === corner[1]));
});

test("a drawn area is closed; one that crosses itself says so", () => {
  const { geometry, fault } = areaOf(drawn);
  assert.equal(fault, "");
  assert.equal(areaOf([...drawn, drawn[0]]).fault, "");
  assert.deepEqual(geometry.coordinates[0].at(0), geometry.coordinates[0].at(-1));
  const [a, b, c, d] = CORNERS;
  assert.notEqual(areaOf([a, c, b, d]).fault, "");
  assert.notEqual(areaOf([a, b]).fault, "");
});

test("it applies from now for so many hours", () => {
  assert.deepEqual(periodOf(Date.UTC(2026, 10, 29, 23), 2), {
    startDateTime: "2026-11-29T23:00:00.000Z",
    endDateTime: "2026-11-30T01:00:00.000Z",
    schedule: [],
  });
});
