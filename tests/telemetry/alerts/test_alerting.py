"""What the watch sees becomes alerts: rows that open, rise and close."""

import math
from datetime import timedelta

import pytest
from django.utils import timezone
from django.utils.translation import override

from mavlink.decoding.measurement import Measurement
from missions.models import Approval, CommandKind, Mission, Uav, UavCommand, UavType
from missions.services.commands.outbox import queue_command
from telemetry.alerting.detector_input import WatchedUav
from telemetry.estimation.report import Report
from telemetry.models import Alert, UavLink, VehicleText
from telemetry.selectors.alert_words import alert_words
from telemetry.services.alerts.alerting import DetectorStates, poll_alerts
from telemetry.services.alerts.down_alerts import close_down_alert
from tests.missions.flights import an_operator, approved, fleet
from tests.missions.worlds import world, zone_around
from tests.telemetry.records import at

pytestmark = pytest.mark.django_db


@pytest.fixture
def uav() -> Uav:
    return fleet("Tern")[0]


@pytest.fixture
def approval(uav) -> Approval:
    approval = approved(an_operator(), [uav], world().towers[:2])[1]
    Mission.objects.filter(pk=approval.mission_id).update(state="active")
    return approval


def watched_uav(uav: Uav, approval: Approval, reported_s: float = 0.0, **values) -> WatchedUav:
    """Above the take-off of its route."""
    first = approval.document["routes"][0]["route"]["waypoints"][0]
    reported = {"longitude_deg": first["position"][0], "latitude_deg": first["position"][1], "waypoint_sequence": 0}
    reported |= {"altitude_relative_m": first["altitude_relative_m"], "is_armed": True, "is_in_air": True}
    measurement = Measurement(**{**reported, **values})
    report = Report(at(reported_s).timestamp(), at(reported_s).timestamp(), measurement)
    return WatchedUav(uav.pk, uav.organisation_id, uav.name, approval.mission_id, approval.pk, newest=report)


def received(uav: Uav, seconds: float) -> None:
    UavLink.objects.update_or_create(uav=uav, defaults={"last_message_at": at(seconds)})


def watching(uav: Uav, approval: Approval) -> DetectorStates:
    """Reports came each second until second 0."""
    states = DetectorStates()
    for second in range(-3, 1):
        received(uav, second)
        poll_alerts(watched=[watched_uav(uav, approval, second)], now=at(second), detector_states=states)
    return states


def test_a_uav_that_is_silent_is_late_then_lost_by_one_alert_and_heard_again_it_is_over(uav, approval):
    states = watching(uav, approval)
    levels = []
    for second in range(30):
        poll_alerts(watched=[watched_uav(uav, approval)], now=at(second), detector_states=states)
        levels.append(Alert.objects.filter(closed_at=None).values_list("level", flat=True).first())
    assert [levels.index("warning"), levels.index("critical")] == [5, 20]
    received(uav, 30)
    for second in range(30, 35):
        poll_alerts(watched=[watched_uav(uav, approval, 30)], now=at(second), detector_states=states)
    alert = Alert.objects.get(code="link-lost")
    assert (alert.opened_at, alert.closed_at, alert.close_reason) == (at(5), at(32), "cleared")


def test_a_uav_whose_flight_was_told_to_be_over_is_not_missed_while_others_fly(uav, approval):
    states = watching(uav, approval)
    poll_alerts(watched=[watched_uav(uav, approval)], now=at(10), detector_states=states)
    UavLink.objects.update(is_in_air=False)
    poll_alerts(watched=[watched_uav(uav, approval)], now=at(30), detector_states=states)
    alert = Alert.objects.get()
    assert (alert.code, alert.level, alert.close_reason) == ("link-lost", "warning", "landed")


def test_a_watch_that_takes_over_opens_nothing_twice_and_closes_what_is_over(uav, approval):
    poll_alerts(watched=[watched_uav(uav, approval)], now=at(25), detector_states=watching(uav, approval))
    poll_alerts(watched=[watched_uav(uav, approval)], now=at(26), detector_states=DetectorStates())
    alert = Alert.objects.get()
    assert (alert.closed_at, alert.revision) == (None, 1)
    received(uav, 27)
    states = DetectorStates()
    for second in range(27, 31):
        poll_alerts(watched=[watched_uav(uav, approval, 27)], now=at(second), detector_states=states)
    assert Alert.objects.get(code="link-lost").closed_at == at(29)


def test_a_raised_level_is_not_acknowledged_any_more(uav, approval):
    states = watching(uav, approval)
    poll_alerts(watched=[watched_uav(uav, approval)], now=at(10), detector_states=states)
    Alert.objects.update(acknowledged_at=at(11))
    poll_alerts(watched=[watched_uav(uav, approval)], now=at(15), detector_states=states)
    assert Alert.objects.get().acknowledged_at == at(11)
    poll_alerts(watched=[watched_uav(uav, approval)], now=at(20), detector_states=states)
    alert = Alert.objects.get()
    assert (alert.level, alert.acknowledged_at) == ("critical", None)


def test_what_is_on_the_ground_is_not_late(uav, approval):
    poll_alerts(watched=[watched_uav(uav, approval, is_armed=False, is_in_air=False)], now=at(60), detector_states=DetectorStates())
    assert not Alert.objects.exists()


@pytest.mark.parametrize("state", ["completed", "aborted", "failed"])
def test_a_mission_that_has_ended_ends_its_alerts(state, uav, approval):
    poll_alerts(watched=[watched_uav(uav, approval)], now=at(60), detector_states=DetectorStates())
    Mission.objects.update(state=state)
    poll_alerts(watched=[], now=at(60) + timedelta(seconds=1), detector_states=DetectorStates())
    assert Alert.objects.get().close_reason == "mission-ended"


def in_flight(second: float, uav: Uav, approval: Approval, states: DetectorStates, **values) -> None:
    received(uav, second)
    poll_alerts(watched=[watched_uav(uav, approval, second, **values)], now=at(second), detector_states=states)


def ordered_to_land(uav: Uav, approval: Approval, second: float) -> None:
    command = queue_command(uav=uav, kind=CommandKind.LAND, actor=an_operator(), mission=Mission.objects.get(pk=approval.mission_id))
    UavCommand.objects.filter(pk=command.pk).update(state="applied", created_at=at(second), finished_at=at(second))


def open_ones() -> list[tuple[str, str]]:
    return sorted(Alert.objects.filter(closed_at=None).values_list("code", "level"))


def test_a_uav_beside_its_route_is_told_with_words_that_grow_older_than_seconds_only(uav, approval):
    states = watching(uav, approval)
    first, then = (waypoint["position"] for waypoint in approval.document["routes"][0]["route"]["waypoints"][:2])
    ahead = math.dist(first, then)
    for second in range(1, 12):
        back = (0.0004 + 0.00001 * second) / ahead
        lon, lat = (here - back * (there - here) for here, there in zip(first, then, strict=True))
        in_flight(second, uav, approval, states, longitude_deg=lon, latitude_deg=lat)
    alert = Alert.objects.get()
    assert (alert.code, alert.level, alert.opened_at) == ("off-route", "warning", at(4))
    assert alert.revision == 2  # its figures are written each five seconds
    assert [step["what"] for step in alert.course] == ["opened"]


def test_a_mode_that_a_command_of_ours_led_to_alarms_nobody(uav, approval):
    states = watching(uav, approval)
    mission = Mission.objects.get(pk=approval.mission_id)
    command = queue_command(uav=uav, kind=CommandKind.RETURN, actor=an_operator(), mission=mission)
    UavCommand.objects.filter(pk=command.pk).update(state="applied", finished_at=at(1))
    for second in range(1, 12):
        in_flight(second, uav, approval, states, mode="RTL")
    assert open_ones() == []
    UavCommand.objects.filter(pk=command.pk).update(state="failed")
    for second in range(12, 16):
        in_flight(second, uav, approval, states, mode="RTL")
    assert open_ones() == [("mode-changed", "critical")]


def test_a_mission_on_the_uav_that_is_not_the_approved_one_is_told(uav, approval):
    states = watching(uav, approval)
    flight = approval.document["routes"][0]["flights"][0]
    loaded = {"loaded_approval": approval.pk, "loaded_flight": 1, "loaded_sha256": flight["content_sha256"]}
    UavLink.objects.filter(uav=uav).update(**loaded)
    for second in range(1, 8):
        in_flight(second, uav, approval, states, mode="MISSION")
    assert open_ones() == []
    UavLink.objects.filter(uav=uav).update(loaded_sha256="f" * 64)
    for second in range(8, 13):
        in_flight(second, uav, approval, states, mode="MISSION")
    assert open_ones() == [("other-mission", "critical")]


def test_a_zone_that_is_saved_around_a_flying_uav_is_told(uav, approval):
    states = watching(uav, approval)
    place = watched_uav(uav, approval).newest.measurement
    zone = zone_around((place.longitude_deg, place.latitude_deg), with_graph=False)
    for second in range(1, 4):
        in_flight(second, uav, approval, states)
    alert = Alert.objects.get()
    assert (alert.code, alert.level, alert.subject, alert.values["zone"]) == ("zone", "critical", str(zone.pk), zone.name)


def test_limits_of_the_mission_go_before_those_of_the_type(uav, approval):
    uav_type = UavType.objects.create(name="Quad", range_unlimited=True, alert_limits={"link_late_s": 30.0, "link_lost_s": 60.0})
    Uav.objects.filter(pk=uav.pk).update(uav_type=uav_type)
    states = watching(uav, approval)
    poll_alerts(watched=[watched_uav(uav, approval)], now=at(25), detector_states=states)
    assert open_ones() == []
    Mission.objects.update(alert_limits={"link_late_s": 10.0})
    poll_alerts(watched=[watched_uav(uav, approval)], now=at(26), detector_states=states)
    assert open_ones() == [("link-lost", "warning")]


def says(uav: Uav, second: float, text: str, severity: int = 4) -> None:
    VehicleText.objects.create(uav=uav, severity=severity, text=text, received_at=at(second))


@pytest.mark.parametrize(("state", "level"), [("low", "warning"), ("critical", "critical"), ("unhealthy", "critical")])
def test_a_battery_that_the_vehicle_itself_calls_low_is_told_however_full_it_says_it_is(state, level, uav, approval):
    states = watching(uav, approval)
    UavLink.objects.update(battery_state=state)
    for second in range(1, 9):
        in_flight(second, uav, approval, states, battery_percent=95.0)
    assert open_ones() == [("battery-short", level)]


def test_words_of_the_vehicle_about_its_battery_count_until_it_says_that_it_is_well(uav, approval):
    states = watching(uav, approval)
    says(uav, 0, "Battery 1 is low 10.5V used 1200 mAh")
    says(uav, 0, "Battery calibrated", severity=6)
    for second in range(1, 9):
        in_flight(second, uav, approval, states, battery_percent=95.0)
    alert = Alert.objects.get()
    assert (alert.code, alert.level, alert.values["words"]) == ("battery-short", "warning", "Battery 1 is low 10.5V used 1200 mAh")
    UavLink.objects.update(battery_state="ok")
    for second in range(9, 45):
        in_flight(second, uav, approval, states, battery_percent=95.0)
    alert.refresh_from_db()
    assert alert.close_reason == "cleared"


def test_a_mode_that_nobody_asked_for_is_told_with_what_the_vehicle_said(uav, approval):
    states = watching(uav, approval)
    says(uav, -60, "EKF3 lane switch 1")
    says(uav, 1, "Battery Failsafe - RTL", severity=2)
    for second in range(1, 12):
        in_flight(second, uav, approval, states, mode="RTL")
    alert = Alert.objects.get(code="mode-changed")
    assert alert_words(alert.message, alert.values).endswith("Autopilot: Battery Failsafe - RTL")
    with override("de"):
        assert "Battery Failsafe - RTL" in alert_words(alert.message, alert.values) != alert_words(alert.message, {})
    for second in range(12, 700, 10):
        in_flight(second, uav, approval, states, mode="RTL")
    alert.refresh_from_db()
    assert alert.values["words"] == "Battery Failsafe - RTL", "it is quoted as long as the mode lasts"


def test_a_uav_that_came_down_beside_its_route_is_told_until_a_person_closes_it(uav, approval):
    states = watching(uav, approval)
    place = watched_uav(uav, approval).newest.measurement
    fallen = {"longitude_deg": place.longitude_deg + 0.01, "altitude_relative_m": 8.0, "is_armed": False, "is_in_air": False}
    UavLink.objects.update(is_in_air=False, is_armed=False)
    for second in range(1, 6):
        in_flight(second, uav, approval, states, **fallen)
    alert = Alert.objects.get()
    assert (alert.code, alert.level, alert.mission_id) == ("down-off-plan", "critical", approval.mission_id)
    assert alert.details["position"] == pytest.approx([place.longitude_deg + 0.01, place.latitude_deg])
    Mission.objects.update(state="failed")
    poll_alerts(watched=[], now=at(60), detector_states=DetectorStates())
    assert open_ones() == [("down-off-plan", "critical")], "the end of its mission does not end it"
    person = an_operator()
    close_down_alert(alert=alert, actor=person, reason="Brought back; motor 3 had failed")
    alert.refresh_from_db()
    assert (alert.close_reason, alert.notes.get().text, alert.course[-1]["what"]) == (
        "by-person",
        "Brought back; motor 3 had failed",
        "closed",
    )
    Mission.objects.update(state="active")
    for second in range(61, 66):
        in_flight(second, uav, approval, states, **fallen)
    assert open_ones() == [], "nobody is told again of what somebody has closed"
    again = queue_command(uav=uav, kind=CommandKind.START, actor=person, mission=Mission.objects.get(pk=approval.mission_id))
    UavCommand.objects.filter(pk=again.pk).update(state="applied", finished_at=timezone.now())
    for second in range(66, 71):
        in_flight(second, uav, approval, states, **fallen)
    assert open_ones() == [("down-off-plan", "critical")], "it was started again since"


def test_a_flight_that_ended_off_its_plan_has_failed_and_its_mission_with_it(uav, approval):
    states = watching(uav, approval)
    place = watched_uav(uav, approval).newest.measurement
    fallen = {"longitude_deg": place.longitude_deg + 0.01, "altitude_relative_m": 8.0, "is_in_air": False}
    UavLink.objects.update(is_in_air=False)
    for second in range(1, 6):
        in_flight(second, uav, approval, states, **fallen, is_armed=True)
    assert Mission.objects.get().state == "active", "it may take off again"
    for second in range(6, 9):
        in_flight(second, uav, approval, states, **fallen, is_armed=False)
    mission = Mission.objects.get()
    assert (mission.state, mission.routes.get().has_failed) == ("failed", True)
    assert set(mission.targets.values_list("state", flat=True)) == {"failed"}
    assert ("down-off-plan", "critical") in open_ones()


def test_a_flight_whose_last_report_came_from_the_ground_off_its_plan_has_failed(uav, approval):
    states = watching(uav, approval)
    place = watched_uav(uav, approval).newest.measurement
    last = {"longitude_deg": place.longitude_deg + 0.01, "altitude_relative_m": 8.0, "is_armed": False, "is_in_air": False}
    UavLink.objects.update(is_in_air=False, is_armed=False)
    for second in range(1, 6):
        poll_alerts(watched=[watched_uav(uav, approval, 1, **last)], now=at(second), detector_states=states)
    assert Mission.objects.get().state == "failed"


@pytest.mark.parametrize("why", ["home early and carried away", "told to land", "silent", "by its companion"])
def test_what_can_go_on_or_is_reported_by_others_is_no_end_of_a_flight(why, uav, approval):
    states = watching(uav, approval)
    place = watched_uav(uav, approval).newest.measurement
    away = {"longitude_deg": place.longitude_deg + 0.01, "is_armed": False, "is_in_air": False}
    away |= {"altitude_relative_m": 0.0, "velocity_down_mps": 0.5}
    if why == "silent":
        for second in range(1, 60, 5):
            poll_alerts(watched=[watched_uav(uav, approval)], now=at(second), detector_states=states)
    else:
        UavLink.objects.update(is_in_air=False, is_armed=False)
        if why == "home early and carried away":
            in_flight(1, uav, approval, states, **away | {"longitude_deg": place.longitude_deg})
        elif why == "told to land":
            ordered_to_land(uav, approval, 0)
        else:
            Uav.objects.update(link="http")
        for second in range(2, 8):
            in_flight(second, uav, approval, states, **away)
    assert Mission.objects.get().state == "active"


def test_no_alert_of_a_uav_closes_because_it_is_down_in_the_wrong_place(uav, approval):
    states = watching(uav, approval)
    for second in range(1, 9):
        in_flight(second, uav, approval, states, battery_percent=9.0, mode="LAND")
    assert {code for code, _ in open_ones()} == {"battery-short", "mode-changed"}
    place = watched_uav(uav, approval).newest.measurement
    fallen = {"longitude_deg": place.longitude_deg + 0.01, "altitude_relative_m": 8.0, "is_armed": False, "is_in_air": False}
    UavLink.objects.update(is_in_air=False, is_armed=False)
    for second in range(9, 40):
        in_flight(second, uav, approval, states, **fallen, battery_percent=9.0, mode="LAND")
    assert {code for code, _ in open_ones()} == {"battery-short", "down-off-plan", "mode-changed"}
    Mission.objects.update(state="failed")
    poll_alerts(watched=[], now=at(40), detector_states=DetectorStates())
    assert len(open_ones()) == 3, "the end of its mission ends none of them either"
    Mission.objects.update(state="active")
    close_down_alert(alert=Alert.objects.get(code="down-off-plan"), actor=an_operator(), reason="Brought back")
    for second in range(41, 44):
        in_flight(second, uav, approval, states, **fallen, battery_percent=9.0, mode="LAND")
    assert open_ones() == [], "a person has said what became of it"


def test_the_worst_that_an_alert_has_said_is_kept(uav, approval):
    states = watching(uav, approval)
    for second, percent in enumerate([15.0] * 8 + [9.0] * 3 + [14.0] * 10, start=1):
        in_flight(second, uav, approval, states, battery_percent=percent)
    alert = Alert.objects.get(code="battery-short")
    assert (alert.values["percent"], alert.details["worst"]["values"]["percent"]) == ("14", "9")


def test_a_uav_that_was_told_to_hold_on_the_ground_has_not_crashed(uav, approval):
    place = watched_uav(uav, approval).newest.measurement
    away = {"longitude_deg": place.longitude_deg + 0.01, "is_armed": False, "is_in_air": False}
    received(uav, 0)
    UavLink.objects.update(is_in_air=False)
    command = queue_command(uav=uav, kind=CommandKind.HOLD, actor=an_operator(), mission=Mission.objects.get(pk=approval.mission_id))
    UavCommand.objects.filter(pk=command.pk).update(state="applied", finished_at=at(0))
    for second in range(1, 6):
        in_flight(second, uav, approval, DetectorStates(), **away)
    assert open_ones() == []


def test_a_uav_that_was_told_to_land_or_has_not_started_is_not_missed(uav, approval):
    place = watched_uav(uav, approval).newest.measurement
    away = {"longitude_deg": place.longitude_deg + 0.01, "is_armed": False, "is_in_air": False}
    received(uav, 0)
    UavLink.objects.update(is_in_air=False)
    for second in range(1, 6):
        in_flight(second, uav, approval, DetectorStates(), **away)
    states = watching(uav, approval)
    ordered_to_land(uav, approval, 0)
    for second in range(1, 6):
        in_flight(second, uav, approval, states, **away)
    assert open_ones() == []


@pytest.mark.parametrize("reports_speed", [True, False])
def test_one_that_falls_is_told_though_it_was_told_to_land(reports_speed, uav, approval):
    states = watching(uav, approval)
    place = watched_uav(uav, approval).newest.measurement
    away = {"longitude_deg": place.longitude_deg + 0.01}
    ordered_to_land(uav, approval, 1)
    for second, height_m in enumerate([60.0, 45.0, 25.0, 4.0], start=1):
        in_flight(second, uav, approval, states, altitude_relative_m=height_m, velocity_down_mps=15.0 if reports_speed else None, **away)
    UavLink.objects.update(is_in_air=False, is_armed=False)
    for second in range(5, 9):
        in_flight(second, uav, approval, states, altitude_relative_m=0.0, is_armed=False, is_in_air=False, **away)
    assert ("down-off-plan", "critical") in open_ones()
    for second in range(9, 25):
        in_flight(second, uav, approval, states, altitude_relative_m=0.0, is_armed=False, is_in_air=False, **away)
    assert ("down-off-plan", "critical") in open_ones(), "until a person closes it"


def test_one_that_was_down_before_it_was_told_to_land_is_told(uav, approval):
    states = watching(uav, approval)
    place = watched_uav(uav, approval).newest.measurement
    fallen = {"longitude_deg": place.longitude_deg + 0.01, "altitude_relative_m": 8.0, "is_armed": False, "is_in_air": False}
    UavLink.objects.update(is_in_air=False, is_armed=False)
    in_flight(1, uav, approval, states, **fallen)
    ordered_to_land(uav, approval, 4)
    for second in range(5, 10):
        in_flight(second, uav, approval, states, **fallen)
    assert open_ones() == [("down-off-plan", "critical")]


def test_a_landing_that_was_asked_for_is_none(uav, approval):
    states = watching(uav, approval)
    place = watched_uav(uav, approval).newest.measurement
    away = {"longitude_deg": place.longitude_deg + 0.01}
    ordered_to_land(uav, approval, 1)
    for second, height_m in enumerate([10.0, 6.0, 3.0, 1.0], start=1):
        in_flight(second, uav, approval, states, altitude_relative_m=height_m, velocity_down_mps=4.0, **away)
    UavLink.objects.update(is_in_air=False, is_armed=False)
    for second in range(5, 20):
        in_flight(second, uav, approval, states, altitude_relative_m=0.0, is_armed=False, is_in_air=False, **away)
    assert ("down-off-plan", "critical") not in open_ones()


def test_an_open_battery_alert_is_answered_by_what_the_uav_does_at_that_moment(uav, approval):
    """Its percentage stays the same: it is neither returning nor commanded, then its failsafe returns it."""
    states = watching(uav, approval)
    for second in range(1, 9):
        in_flight(second, uav, approval, states, battery_percent=15.0, mode="AUTO")
    alert = Alert.objects.get(code="battery-short")
    assert [act["kind"] for act in alert.details["acts"]] == ["return"]
    assert "own_act" not in alert.details
    in_flight(9, uav, approval, states, battery_percent=15.0, mode="RTL")
    alert.refresh_from_db()
    assert (alert.level, alert.details["acts"]) == ("critical", [])
    assert alert.details["own_act"] == {"kind": "return", "since": at(9).isoformat(), "is_commanded": False}


def test_an_alert_that_keeps_a_worse_level_keeps_its_words_and_is_answered_as_of_now(uav, approval):
    states = watching(uav, approval)
    for second in range(1, 9):
        in_flight(second, uav, approval, states, battery_percent=15.0, mode="AUTO")
    words = Alert.objects.get(code="battery-short").message
    in_flight(9, uav, approval, states, battery_percent=24.0, mode="RTL")
    alert = Alert.objects.get(code="battery-short")
    assert (alert.level, alert.message, alert.details["acts"], alert.details["own_act"]["kind"]) == ("critical", words, [], "return")


def test_of_a_uav_that_came_down_the_position_is_said_as_it_is_copied(uav, approval):
    place = watched_uav(uav, approval).newest.measurement
    states = watching(uav, approval)
    for second in range(1, 9):
        fallen = {"longitude_deg": place.longitude_deg + 0.01, "altitude_relative_m": 8.0, "is_armed": False, "is_in_air": False}
        in_flight(second, uav, approval, states, **(fallen if second > 3 else {}))
    alert = Alert.objects.get(code="down-off-plan")
    lon, lat = alert.details["position"]
    assert f"last at {lat:.5f}° N, {lon:.5f}° E:" in alert_words(alert.message, alert.values)
