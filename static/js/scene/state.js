/** What the view looks at: one UAV, one target, a moment; what of it stands in a link. Values in, values out. */

const NO_DATE_HOUR = 10; // by the sun, of flights that have no departure

/** The place of the next of places after one, in a circle. */
export function nextOf(places, at, step) {
  if (!places.length) return null;
  const index = places.indexOf(at);
  return places[index < 0 ? 0 : (index + step + places.length) % places.length];
}

/** The target to look at: the one asked for, else that of the UAV's task, else the nearest one of its route. */
export function targetToSee({ targets }, wanted, task, route) {
  const known = (place) => targets.find((target) => target.place === place) ?? null;
  return known(wanted) ?? known(task?.target) ?? targets.find((target) => target.route === route) ?? targets[0] ?? null;
}

/** The day and hour that the sun stands at: those of the flight; without a departure ten in the morning, by the sun, of `today`. */
export function sunTime(source, at_ms, longitude_deg, today = Date.now()) {
  if (source.hasDate) return new Date(at_ms);
  const day = Math.floor(today / 86_400_000) * 86_400_000;
  return new Date(day + (NO_DATE_HOUR - longitude_deg / 15) * 3_600_000 + (at_ms - source.departs_ms));
}

/** Where a UAV was last heard, by the moment of its report: of an estimate's piece the report before it. */
export function reportBefore(route, moment) {
  const piece = route.pieces.findLast(({ samples }) => samples[0].at_ms <= moment.at_ms);
  return piece?.samples[0] ?? null;
}
