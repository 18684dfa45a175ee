"""What is said of a battery, and what is proposed."""

import math
from datetime import UTC, datetime

import pytest

from inspection.geodesy import LonLat
from mavlink.decoding.measurement import Measurement
from mavlink.rtl import rtl_behaviour
from telemetry.alerting.advice import ADVICE, OWN_ACT
from telemetry.alerting.detection import CRITICAL, WARNING, Detection, acts_of
from telemetry.alerting.detector_input import WatchedUav
from telemetry.alerting.detectors import battery
from telemetry.alerting.surroundings import IssuedOrder, LinkFacts
from telemetry.estimation.report import Report
from tests.telemetry.alerting.truth import MISSION, START_S, TrueFlight, true_flight
from tests.telemetry.alerting.watch import Watch

SEED = 3


@pytest.fixture(scope="module")
def flight() -> TrueFlight:
    return true_flight(SEED, least_leg_m=700.0)


def reported(flight: TrueFlight, second: int, left_percent: float, mode: str = "MISSION", *, moves: bool = True) -> Measurement:
    state = flight.states[second]
    position = flight.position(state.east, state.north)
    east, north = flight.conditions.wind_at(60.0)
    return Measurement(
        longitude_deg=position.lon, latitude_deg=position.lat, altitude_relative_m=state.height_m, mode=mode, is_armed=True, is_in_air=True,
        velocity_east_mps=state.east_mps if moves else 0.0, velocity_north_mps=state.north_mps if moves else 0.0, velocity_down_mps=0.0,
        battery_percent=left_percent, waypoint_sequence=state.vertex, wind_east_mps=east, wind_north_mps=north,
    )  # fmt: skip


def found(flight: TrueFlight, measured: Measurement, watch: Watch | None = None, second: float = 0.0, **around) -> Detection | None:
    watch = watch or Watch()
    now_s = START_S + second
    uav = WatchedUav(7, 1, "Tern", MISSION, MISSION, newest=Report(now_s, now_s, measured))
    return next(iter(battery.detect(watch.inputs(now_s, uav, model=flight.model, **around)) or ()), None)


def far_from_home(flight: TrueFlight) -> int:
    return max(flight.cruising(20), key=lambda second: abs(flight.states[second].east) + abs(flight.states[second].north))


def proposed(detection: Detection) -> list[tuple[str, int]]:
    return [(act["kind"], act["uav"]) for act in acts_of(detection.code, 7, detection.details)]


def test_the_climb_to_the_height_of_its_return_counts_in_the_way_home(flight):
    """60 m more up at 2.5 m/s, and down again at 1.5."""
    second = far_from_home(flight)
    height_m = flight.states[second].height_m

    def home(**link) -> dict:
        watch = Watch()
        found(flight, reported(flight, second, 60.0), watch, link=LinkFacts(**link))
        return watch.detector_state.battery

    level = home()
    high = home(rtl_behaviour=rtl_behaviour("ardupilot", {"RTL_ALT": (height_m + 60.0) * 100.0, "RTL_ALT_TYPE": 0.0}))
    per_s = flight.model.consumption.percent_per_s(0.0)
    assert high["home_s"] - level["home_s"] == pytest.approx(60.0 / flight.model.consumption.climb_mps + 60.0 / 1.5, abs=1.0)
    assert high["home_percent"] - level["home_percent"] > 0.9 * per_s * (60.0 / flight.model.consumption.climb_mps + 60.0 / 1.5)
    low = home(rtl_behaviour=rtl_behaviour("ardupilot", {"RTL_ALT": 1_000.0, "RTL_CLIMB_MIN": 0.0, "RTL_ALT_TYPE": 0.0}))
    assert low["home_percent"] == level["home_percent"], "it never comes down first"


def test_a_hold_is_no_drain_of_distance(flight):
    """Held for two minutes, with the drain of a hover, and resumed: what is left is enough for its route, and nothing is said."""
    watch, second = Watch(), far_from_home(flight)
    per_s, left = flight.model.consumption.percent_per_s(0.0), 100.0 - flight.states[second].used_percent
    levels = []
    for after_s in range(135):
        is_held = 5 <= after_s < 125
        now = second + min(after_s, 5) + max(after_s - 125, 0)
        left = left - per_s if is_held else 100.0 - flight.states[now].used_percent - per_s * (120 if after_s >= 125 else 0)
        measured = reported(flight, now, float(round(left)), "LOITER" if is_held else "MISSION", moves=not is_held)
        detection = found(flight, measured, watch, after_s)
        levels.append(detection.level if detection else None)
    assert CRITICAL not in levels


@pytest.mark.parametrize(("left_percent", "level"), [(80.0, None), (19.0, CRITICAL), (8.0, CRITICAL)])
def test_below_its_reserve_is_critical_whatever_it_does(left_percent, level, flight):
    second = flight.cruising(20)[-1]  # near its end
    for mode in ("MISSION", "LOITER", "RTL"):
        detection = found(flight, reported(flight, second, left_percent, mode))
        assert (detection and detection.level) == level
    assert level is None or detection.values == {"uav": "Tern", "percent": f"{left_percent:.0f}", "reserve": "20"}


def test_reserve_and_the_way_home_reached_is_a_warning_that_proposes_to_return(flight):
    measured = reported(flight, far_from_home(flight), 60.0, "LOITER", moves=False)
    watch = Watch()
    assert found(flight, measured, watch) is None
    home_percent = watch.detector_state.battery["home_percent"]
    assert home_percent > 5.0
    detection = found(flight, reported(flight, far_from_home(flight), 20.0 + home_percent - 0.5, "LOITER", moves=False))
    assert (detection.level, detection.message, proposed(detection)) == (WARNING, battery.TURN_BACK, [("return", 7)])


def home_percent_of(flight: TrueFlight, second: int) -> float:
    watch = Watch()
    found(flight, reported(flight, second, 60.0, "LOITER", moves=False), watch)
    return watch.detector_state.battery["home_percent"]


def advised(detection: Detection) -> str | None:
    status_texts = detection.details.get(ADVICE)
    return status_texts and status_texts["message"] % status_texts["values"]


def test_below_its_reserve_a_return_that_reaches_home_is_proposed_with_what_is_left_there(flight):
    second = next(second for second in flight.cruising(20) if 8.0 < home_percent_of(flight, second) < 13.5)
    detection = found(flight, reported(flight, second, 19.0, "LOITER", moves=False))
    lands = round(19.0 - home_percent_of(flight, second))
    assert proposed(detection) == [("return", 7)]
    assert advised(detection) == f"A return lands with about {lands} % of the battery, below the reserve of 20 %."


def test_a_return_that_leaves_hardly_any_stands_beside_a_landing_here(flight):
    second = far_from_home(flight)
    detection = found(flight, reported(flight, second, home_percent_of(flight, second) + 2.4, "LOITER", moves=False))
    assert (detection.level, proposed(detection)) == (CRITICAL, [("return", 7), ("land", 7)])
    assert advised(detection) == "A return lands with about 2 % of the battery only: land here if the ground allows it."


def test_where_home_is_out_of_reach_the_alert_says_why_return_is_missing(flight):
    second = far_from_home(flight)
    home = home_percent_of(flight, second)
    detection = found(flight, reported(flight, second, home - 1.0, "LOITER", moves=False))
    assert proposed(detection) == [("land", 7)]
    assert advised(detection) == f"Return is not offered: it takes about {home:.0f} % of the battery, and {home - 1.0:.0f} % is left."


def test_where_home_is_out_of_reach_the_nearest_landing_place_is_proposed(flight):
    second = far_from_home(flight)
    state, home = flight.states[second], home_percent_of(flight, second)
    near = flight.position(state.east + 60.0, state.north)
    with_landing = TrueFlight(**{**vars(flight), "model": _with_rally(flight, near)})
    detection = found(with_landing, reported(flight, second, home + 2.0, "LOITER", moves=False))
    assert proposed(detection) == [("return", 7)]
    assert advised(detection).startswith("A return leads to the landing place 60 m away and lands there with about")


def _with_rally(flight: TrueFlight, point: LonLat):
    fields = {name: getattr(flight.model, name) for name in flight.model.__slots__}
    return type(flight.model)(**{**fields, "rally_points": (point,)})


@pytest.mark.parametrize(("mode", "kind"), [("LAND", "land"), ("RTL", "return")])
def test_a_uav_that_comes_down_by_its_own_failsafe_is_left_alone_and_the_alert_says_since_when(mode, kind, flight):
    watch, second = Watch(), flight.cruising(20)[-1]
    link = LinkFacts(battery_state="critical")
    found(flight, reported(flight, second, 15.0), watch, link=link)
    detection = found(flight, reported(flight, second, 15.0, mode), watch, 3.0, link=link)
    assert (detection.level, proposed(detection)) == (CRITICAL, [])
    since = datetime.fromtimestamp(START_S + 3.0, UTC).isoformat()
    assert detection.details[OWN_ACT] == {"kind": kind, "since": since, "is_commanded": False}
    detection = found(flight, reported(flight, second, 15.0, mode), watch, 9.0, link=link, order=IssuedOrder("return", START_S))
    assert detection.details[OWN_ACT] == {"kind": kind, "since": since, "is_commanded": True}


def test_a_return_that_is_too_short_of_battery_to_reach_home_can_be_cut_by_a_landing(flight):
    second = far_from_home(flight)
    home = home_percent_of(flight, second)
    returning = reported(flight, second, home - 2.0, "RTL")
    detection = found(flight, returning)
    assert (proposed(detection), detection.details[OWN_ACT]["since"]) == ([("land", 7)], None)
    assert advised(detection).startswith("Its battery does not last for the return")
    detection = found(flight, reported(flight, second, home + 2.0, "RTL"))
    assert (proposed(detection), advised(detection)) == ([("land", 7)], "It lands with about 2 % of the battery (reserve 20 %).")
    assert proposed(found(flight, reported(flight, second, home + 12.0, "RTL"))) == [], "it gets home"


def test_a_uav_whose_battery_is_not_known_by_its_energy_is_judged_by_what_it_reports():
    uav = WatchedUav(7, 1, "Tern", MISSION, MISSION, newest=Report(START_S, START_S, Measurement(battery_percent=15.0, is_in_air=True)))
    (detection,) = battery.detect(Watch().inputs(START_S, uav))
    assert (detection.level, detection.message) == (CRITICAL, battery.BELOW)


def test_pages_are_told_minutes_to_the_reserve_and_home(flight):
    watch = Watch()
    found(flight, reported(flight, far_from_home(flight), 60.0), watch)
    assert (
        watch.detector_state.battery["level"] == ""
        and watch.detector_state.battery["reserve_in_s"] > 60 < watch.detector_state.battery["home_s"]
    )


def test_a_hold_lasts_as_long_as_more_is_left_than_the_way_home_and_the_reserve_take(flight):
    watch, second = Watch(), far_from_home(flight)
    found(flight, reported(flight, second, 80.0), watch)
    battery_now = watch.detector_state.battery
    spare = 80.0 - battery_now["reserve_percent"] - battery_now["home_percent"]
    wind_mps = math.hypot(*flight.conditions.wind_at(60.0))
    assert battery_now["hold_s"] == pytest.approx(spare / flight.model.consumption.percent_per_s(wind_mps), rel=0.02)


def test_pages_are_told_what_is_left_at_landing_by_the_way_that_it_flies_now(flight):
    second, left = far_from_home(flight), 80.0
    lands = {}
    for mode in ("AUTO", "RTL", "LOITER"):
        watch = Watch()
        found(flight, reported(flight, second, left, mode), watch)
        lands[mode] = watch.detector_state.battery["lands_percent"]
    rest = flight.model.energy.rest_at(watch.detector_state.place, flight.model.energy.used_at(watch.detector_state.place, 1.0))
    assert lands["AUTO"] == pytest.approx(left - rest, abs=1.0)
    assert lands["RTL"] == pytest.approx(left - watch.detector_state.battery["home_percent"], abs=0.1) != lands["AUTO"]
    assert lands["LOITER"] is None, "it is held"


def test_a_hold_that_drains_more_than_planned_lasts_less(flight):
    watch, second = Watch(), far_from_home(flight)
    per_s, left = flight.model.consumption.percent_per_s(math.hypot(*flight.conditions.wind_at(60.0))), 95.0
    planned_s = None
    for after_s in range(0, 120):
        found(flight, reported(flight, second, left, "LOITER", moves=False), watch, float(after_s))
        planned_s = planned_s or watch.detector_state.battery["hold_s"]
        left -= 2.0 * per_s
    as_planned_s = planned_s - 120.0 * 2.0
    assert watch.detector_state.battery["hold_s"] < 0.8 * as_planned_s


def test_one_with_nothing_to_spare_cannot_hold(flight):
    watch = Watch()
    found(flight, reported(flight, far_from_home(flight), 21.0), watch)
    assert watch.detector_state.battery["hold_s"] == 0
