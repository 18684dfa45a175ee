/** The area of terrain that a flight needs around it. Values in, values out. */

/** @import { FlightSource } from "../types.d.ts" */

const ROUND_M = 900; // on each side of the flight
const MAX_LENGTH_M = 39_000; // longest side that the server returns at once
const METRES_PER_DEGREE = 111_195;

/**
 * Returns west, south, east, north round places, cut to the largest box of a request; null without places.
 *
 * @param {readonly number[][]} places lon, lat
 */
export function boxRound(places) {
  if (!places.length) return null;
  const spans = [0, 1].map((axis) => {
    const values = places.map((place) => place[axis]);
    return [
      values.reduce((least, value) => Math.min(least, value)),
      values.reduce((most, value) => Math.max(most, value)),
    ];
  });
  const latitude = (spans[1][0] + spans[1][1]) / 2;
  const metres = [METRES_PER_DEGREE * Math.cos((latitude * Math.PI) / 180), METRES_PER_DEGREE];
  const [[west, east], [south, north]] = spans.map(([least, most], axis) => {
    const middle = (least + most) / 2;
    const half = Math.min((most - least) / 2 + ROUND_M / metres[axis], MAX_LENGTH_M / 2 / metres[axis]);
    return [middle - half, middle + half];
  });
  return [west, south, east, north].map((degrees) => Number(degrees.toFixed(5)));
}

/** All places of a source: planned, flown, its targets. @param {Pick<FlightSource, "routes" | "targets">} source */
export function placesOf({ routes, targets }) {
  return [
    ...routes.flatMap(({ planned, pieces }) => [
      ...planned.map(({ position }) => position),
      ...pieces.flatMap(({ samples }) => samples.map(({ position }) => position)),
    ]),
    ...targets.map(({ position }) => position),
  ];
}
