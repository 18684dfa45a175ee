"""Beside wires a UAV is warned of by its distance in space from the route: none of a flight in strong wind, all that leave the leg."""

from collections.abc import Iterator
from functools import cache

import pytest

from mavlink.approved_route import Flight, FrozenRoute
from mavlink.decoding.measurement import Measurement
from mavlink.mission_items import flight_loads
from planning.views.limits import DetailRules
from planning.views.view_plan import ViewSpeeds, detail_plan
from simulation.flight.events import ItemReached
from simulation.flight.flown import FlownFlightLog
from simulation.rehearsing.weather_scenario import Named
from telemetry.alerting.detection import CRITICAL, WARNING
from telemetry.alerting.detector_input import WatchedUav
from telemetry.alerting.detectors import DETECTORS
from telemetry.alerting.route_line import RouteLine
from telemetry.alerting.surroundings import FlightModel
from telemetry.estimation.report import Report
from tests.planning.views.flown_photos import flight_of
from tests.planning.views.towers import TOWERS, ZOOM, standing
from tests.telemetry.alerting.truth import MISSION, START_S
from tests.telemetry.alerting.watch import Watch

OF_ROUTE = [detector for detector in DETECTORS if detector.code in {"off-route", "height-off"}]
TOWER = "lattice, 110 kV, triangle"


@cache
def in_strong_wind() -> tuple[FrozenRoute, FlownFlightLog]:
    stands = standing(TOWERS[TOWER])
    plan = detail_plan(stands.site, ZOOM, DetailRules(0.004), ViewSpeeds())
    return flight_of(stands, plan, ZOOM, Named.STRONG_WIND)


def reports(route: FrozenRoute, log: FlownFlightLog, *, up_m: float = 0.0, east_m: float = 0.0, height: bool = True) -> Iterator[Report]:
    """One a second; up_m and east_m: where the UAV is moved to on the way from its second photo to its fourth."""
    items = flight_loads(route)[0].mission
    moved = photo_waypoints(route.flights[0])[1:3]
    reached = sorted((event.at_s, event.index) for event in log.events if isinstance(event, ItemReached))
    for second in range(1, int(log.samples[-1].at_s)):
        sample = next(own for own in log.samples if own.at_s >= second)
        done = max((index for at_s, index in reached if at_s <= second), default=0)
        waypoint = items[min(done + 1, len(items) - 1)].waypoint
        is_moved = waypoint is not None and moved[0] < waypoint <= moved[1]
        height_m = sample.altitude_relative_m + (up_m if is_moved else 0.0)
        measured = Measurement(
            longitude_deg=sample.lon + (east_m / 75_900.0 if is_moved else 0.0), latitude_deg=sample.lat, mode="MISSION",
            altitude_relative_m=height_m if height else None, is_armed=True, is_in_air=True, waypoint_sequence=waypoint,
        )  # fmt: skip
        yield Report(START_S + second, START_S + second, measured)


def photo_waypoints(flight: Flight) -> list[int]:
    return [own.sequence for own in flight.waypoints if own.task is not None and own.task.view is not None]


def watched(**moved: float) -> Watch:
    route, log = in_strong_wind()
    model = FlightModel(line=RouteLine(route.flights[0]), energy=None, max_airspeed_mps=15.0, reserve_percent=20.0)
    watch = Watch()
    for report in reports(route, log, **moved):
        uav = WatchedUav(1, 1, "Tern", MISSION, MISSION, newest=report)
        watch.evaluate(watch.inputs(report.received_s, uav, model=model), OF_ROUTE)
    return watch


@pytest.mark.long
def test_a_flight_in_strong_wind_with_gusts_raises_nothing() -> None:
    assert watched().events == []


@pytest.mark.parametrize("moved", [{"up_m": -8.0}, {"east_m": 8.0}, {"up_m": -5.5, "east_m": 5.5}])
def test_what_leaves_a_leg_beside_wires_by_half_the_clearance_is_critical(moved: dict[str, float]) -> None:
    assert [(event.code, event.level) for event in watched(**moved).opened()] == [("off-route", CRITICAL)]


def test_before_that_it_is_a_warning() -> None:
    route, _ = in_strong_wind()
    (clearance_m,) = set(RouteLine(route.flights[0]).clearances_m.values())
    assert [event.level for event in watched(east_m=0.42 * clearance_m).opened()] == [WARNING]


def test_without_a_height_the_distance_beside_the_leg_counts() -> None:
    assert watched(up_m=-8.0, height=False).opened() == []
    assert [event.level for event in watched(east_m=8.0, height=False).opened()] == [CRITICAL]
