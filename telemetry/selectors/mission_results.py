"""Results of a mission for its files."""

from collections.abc import Iterator, Sequence
from datetime import UTC, datetime

from django.utils.translation import gettext as _
from django.utils.translation import gettext_noop

from inspection.geodesy import LonLat
from inspection.selectors import asset_label, references_of
from telemetry.exports.results import IncidentRow, MissionResults, PlannedPoint, ResultRow, RouteLines, TrackPoint
from telemetry.exports.thinning import EARLY, INTERVAL_S
from telemetry.mission_report.fix import Fix
from telemetry.mission_report.flown_route import MAX_GAP_S
from telemetry.mission_report.outcomes import Incident
from telemetry.selectors.captures import all_captures
from telemetry.selectors.mission_record import RouteOnRecord, TargetOnRecord, WholeRecord, at, in_flown_order
from telemetry.selectors.report_words import reason_words

RESULT_WORDS = {
    "inspected": gettext_noop("Inspected"),
    "not-confirmed": gettext_noop("Complete, not confirmed"),
    "not-inspected": gettext_noop("Not inspected"),
    "open": gettext_noop("Open"),
}


def mission_results(whole: WholeRecord) -> MissionResults:
    """Return the results: targets in flown order, tracks with one point per second."""
    mission = whole.mission
    assets = {target.row.asset_id for target in whole.targets if target.row.asset_id is not None}
    external_ids = {key: row.external_id for key, row in references_of(mission.organisation_id, assets).items()}
    names = {route.place: route.name for route in whole.routes}
    return MissionResults(
        mission.name,
        [_row(number, target, external_ids) for number, target in enumerate(in_flown_order(whole.targets), start=1)],
        [_lines(route) for route in whole.routes],
        [_incident(one, names) for one in whole.incidents],
        list(all_captures(mission)),
    )


def _incident(incident: Incident, names: dict[int, str]) -> IncidentRow:
    name = "" if incident.place is None else names[incident.place]
    return IncidentRow(datetime.fromtimestamp(incident.at_s, UTC), name, reason_words(incident.reason), incident.position)


def _row(number: int, target: TargetOnRecord, external_ids: dict[int, str]) -> ResultRow:
    row, visit, outcome = target.row, target.visit, target.outcome
    asset = row.asset
    line = asset.line if asset is not None and asset.line_id is not None else asset if asset is not None and asset.kind == "line" else None
    place = row.place
    return ResultRow(
        number=number,
        asset_id=row.asset_id,
        external_id=external_ids.get(row.asset_id or 0, ""),
        asset=row.label,
        line="" if line is None else asset_label(line),
        result=outcome.result.value,
        result_words=_(RESULT_WORDS[outcome.result.value]),
        reason="" if outcome.reason is None else reason_words(outcome.reason),
        reason_at=None if outcome.reason is None else at(outcome.reason.at_s),
        uav="" if target.route is None else target.route.name,
        reached_at=None if visit is None else at(visit.reached_s),
        planned_hold_s=None if visit is None else visit.planned_hold_s,
        held_s=None if visit is None or visit.reached_s is None else visit.held_s,
        distance_m=None if visit is None else visit.closest_m,
        altitude_relative_m=None if visit is None else visit.altitude_relative_m,
        position=None if place is None else LonLat(*place.coords[:2]),
    )


def _lines(route: RouteOnRecord) -> RouteLines:
    ground_m = route.route.take_off.altitude_amsl_m

    def amsl_m(relative_m: float | None) -> float | None:
        return None if ground_m is None or relative_m is None else ground_m + relative_m

    def point(fix: Fix) -> TrackPoint:
        at_moment = datetime.fromtimestamp(fix.at_s, UTC)
        return TrackPoint(at_moment, fix.position, fix.altitude_relative_m, amsl_m(fix.altitude_relative_m))

    return RouteLines(
        route.name,
        tuple(PlannedPoint(one.position, one.altitude_relative_m, amsl_m(one.altitude_relative_m)) for one in route.route.waypoints),
        tuple(tuple(map(point, run)) for run in _runs(route.in_air)),
    )


def _runs(fixes: Sequence[Fix]) -> Iterator[list[Fix]]:
    """Yield runs with one fix per second, split at gaps; runs of a single fix are omitted."""
    run: list[Fix] = []
    for fix in fixes:
        if run and fix.at_s - run[-1].at_s > MAX_GAP_S:
            if len(run) > 1:
                yield run
            run = []
        if not run or fix.at_s - run[-1].at_s >= INTERVAL_S * (1.0 - EARLY):
            run.append(fix)
    if len(run) > 1:
        yield run
