"""What a UAV found at its targets: stored once, of its own route alone, and the mission follows."""

from typing import Any

import pytest

from missions.models import Approval, CommandKind, LinkKind, Mission, MissionState, TargetState, Uav
from missions.services.approval.approval import revoke_approval
from missions.services.commands.outbox import queue_command
from telemetry.models import InspectionResult, UavLink
from telemetry.selectors.watched import watched_flights
from tests.missions.flights import an_operator, approved, dispatched
from tests.missions.worlds import World
from tests.telemetry.links.uav_clients import UavClient, linked_uav, report, seconds_ago
from workspace.models import User

pytestmark = pytest.mark.django_db


@pytest.fixture
def person() -> User:
    return an_operator()


@pytest.fixture
def kite() -> UavClient:
    return linked_uav("Kite", is_simulated=True)


@pytest.fixture
def mission(here: World, person: User, kite: UavClient) -> Mission:
    return dispatched(person, [kite.uav], [here.towers[1], here.bridge])


def result(sequence: int = 1, place: int = 0, outcome: str = "complete", **more: Any) -> dict[str, Any]:
    facts = {"sequence": sequence, "place": place, "outcome": outcome, "measured_at": seconds_ago(5)}
    return facts | {"approval": str(Approval.objects.latest("approved_at").pk)} | more


def notify(uav: UavClient, *results: Any, **more: Any) -> Any:
    answer = uav.post("results", {"stream": "boot-1", "results": list(results)} | more)
    assert answer.status_code == 200, answer.content
    return answer.json()


def states() -> list[str]:
    return list(Mission.objects.get().targets.order_by("sequence").values_list("state", flat=True))


def test_a_result_is_stored_and_moves_its_target(mission: Mission, kite: UavClient) -> None:
    reported = notify(kite, result(1, 0, note="two photos", values={"photos": 2, "rust": "no"}), result(2, 1, "failed"))
    assert reported == {"stored": 2, "known": 0, "refused": [], "refused_flights": []}
    assert states() == [TargetState.COMPLETE, TargetState.FAILED]
    first = InspectionResult.objects.get(sequence=1)
    assert (first.note, first.values, first.uav, first.mission) == ("two photos", {"photos": 2, "rust": "no"}, kite.uav, mission)
    assert first.target == mission.targets.get(sequence=0)


def test_a_result_that_is_sent_again_is_stored_once(mission: Mission, kite: UavClient) -> None:
    first, second = result(1), result(2, 1)
    notify(kite, first)
    reported = notify(kite, first, second, second)
    assert (reported["stored"], reported["known"], reported["refused"]) == (1, 2, [])
    assert states() == [TargetState.COMPLETE, TargetState.COMPLETE]


def test_another_result_under_a_number_that_is_taken_is_refused_and_not_called_known(mission: Mission, kite: UavClient) -> None:
    notify(kite, result(1, 0, measured_at=seconds_ago(60)))
    reported = notify(kite, result(1, 0, "failed"), result(1, 1), result(2, 1, "skipped"))
    assert (reported["stored"], reported["known"]) == (1, 0)
    assert [(refused["index"], list(refused["faults"])) for refused in reported["refused"]] == [(0, ["sequence"]), (1, ["sequence"])]
    assert states() == [TargetState.COMPLETE, TargetState.SKIPPED]


def test_the_newest_result_of_a_target_counts_in_whatever_order_they_come(mission: Mission, kite: UavClient) -> None:
    notify(kite, result(2, outcome="complete", measured_at=seconds_ago(10)))
    notify(kite, result(1, outcome="failed", measured_at=seconds_ago(100)))
    assert states()[0] == TargetState.COMPLETE


def test_a_clock_that_is_ahead_settles_nothing_for_good(mission: Mission, kite: UavClient) -> None:
    notify(kite, result(1, outcome="failed", measured_at=seconds_ago(-10 * 365 * 86_400)))
    notify(kite, result(2, outcome="complete", measured_at=seconds_ago(-1)))
    assert states()[0] == TargetState.COMPLETE


def test_another_uavs_target_and_a_mission_that_was_not_sent_are_refused(here: World, person: User, kite: UavClient) -> None:
    tern = linked_uav("Tern", is_simulated=True)
    dispatched(person, [kite.uav, tern.uav], [here.towers[1], here.towers[4]])
    (own,) = kite.get("route").json()["route"]["targets"]
    other = 1 - own["place"]
    reported = notify(kite, result(1, own["place"]), result(2, other), result(3, 7), result(4, own["place"], approval="0" * 32))
    assert reported["stored"] == 1
    assert [(refused["index"], list(refused["faults"])) for refused in reported["refused"]] == [
        (1, ["place"]),
        (2, ["place"]),
        (3, ["place"]),
    ]
    assert states()[other] == TargetState.PENDING
    assert [refused["index"] for refused in notify(linked_uav("Gull"), result(1, own["place"]))["refused"]] == [0]


def test_a_target_is_of_the_mission_that_the_result_names(here: World, person: User, kite: UavClient) -> None:
    """The same place in another mission of the same UAV is another target."""
    first = dispatched(person, [kite.uav], [here.towers[1], here.bridge])
    of_first = Approval.objects.get()
    kite.get("route")
    revoke_approval(mission=first, actor=person, reason="wind")
    clear = kite.get("route").json()["commands"][0]["id"]
    kite.post("acknowledgements", {"acknowledgements": [{"command": clear, "state": "applied"}]})
    second = dispatched(person, [kite.uav], [here.towers[4]])
    reported = notify(kite, result(1, 0, approval=str(of_first.pk)), result(2, 1))
    assert (reported["stored"], [refused["index"] for refused in reported["refused"]]) == (1, [1])
    assert set(first.targets.values_list("state", flat=True)) == {TargetState.PENDING}
    assert second.targets.get().state == TargetState.PENDING
    assert InspectionResult.objects.get().mission == first


def test_a_mission_that_was_approved_but_not_sent_takes_no_results(here: World, person: User, kite: UavClient) -> None:
    approved(person, [kite.uav], [here.towers[1]])
    assert len(notify(kite, result())["refused"]) == 1


def test_a_result_of_a_revoked_approval_is_kept_and_touches_no_target(mission: Mission, person: User, kite: UavClient) -> None:
    kite.get("route")
    late = result()
    revoke_approval(mission=mission, actor=person, reason="wind")
    clear = kite.get("route").json()["commands"][0]["id"]
    kite.post("acknowledgements", {"acknowledgements": [{"command": clear, "state": "applied"}]})
    assert Mission.objects.get().state == MissionState.PLANNED
    assert notify(kite, late)["stored"] == 1
    assert InspectionResult.objects.get().target is None
    assert states()[0] == TargetState.PENDING


def test_faulty_results_are_named_and_hold_up_nothing(mission: Mission, kite: UavClient) -> None:
    faulty = [
        result(1, outcome="perhaps"), result(2, values={"depth": float("nan")}), result(3, values={"text": "x" * 70_000}),
        result(4, measured_at="now"), result(5, altitude=3), result(6, measured_at="2026-11-22T12:00:00"), "seven",
    ]  # fmt: skip
    reported = notify(kite, *faulty, result(8))
    assert reported["stored"] == 1
    faults = [list(refused["faults"]) for refused in reported["refused"]]
    assert faults == [["outcome"], ["values"], ["values"], ["measured_at"], ["altitude"], ["measured_at"], ["non_field_errors"]]


def test_a_mission_is_complete_when_its_last_flight_is_flown(mission: Mission, kite: UavClient) -> None:
    route = kite.get("route").json()["route"]
    start = queue_command(uav=kite.uav, kind=CommandKind.START, actor=None, mission=mission, approval=Approval.objects.get())
    kite.get("route")
    reported = [{"command": route["command"], "state": "applied", "content_sha256": route["content_sha256"]}]
    kite.post("acknowledgements", {"acknowledgements": [*reported, {"command": str(start.pk), "state": "applied"}]})
    flight = {"approval": route["approval"], "flight": 1, "outcome": "flown"}
    answer = notify(kite, result(1, 0, "skipped"), flights=[flight, flight | {"approval": "0" * 32}])
    assert answer["refused_flights"] == [1]
    assert Mission.objects.get().state == MissionState.COMPLETED
    assert states() == [TargetState.SKIPPED, TargetState.COMPLETE]
    assert kite.get("route").status_code == 204
    notify(kite, flights=[flight])
    assert Mission.objects.get().state == MissionState.COMPLETED


def test_a_uav_whose_flight_is_told_to_be_over_is_down_though_no_report_says_so(mission: Mission, kite: UavClient) -> None:
    """Else it would be watched, and missed, long after its mission has ended."""
    kite.get("route")
    flight = {"approval": str(Approval.objects.get().pk), "flight": 1, "outcome": "flown"}
    assert kite.report(report(1, mode="Mission", is_in_air=True)).status_code == 200
    assert [flown.uav_id for flown in watched_flights()] == [kite.uav.pk]
    notify(kite, flights=[flight])
    assert Mission.objects.get().state == MissionState.COMPLETED
    assert watched_flights() == []
    kite.report(report(2, measured_at=seconds_ago(0), mode="Mission", is_in_air=True))
    notify(kite, flights=[flight])
    assert UavLink.objects.get(uav=kite.uav).is_in_air, "it has taken off again since, and the same word comes twice"


def test_a_flight_that_was_never_approved_ends_no_mission(mission: Mission, kite: UavClient) -> None:
    kite.get("route")
    flight = {"approval": str(Approval.objects.get().pk), "flight": 2, "outcome": "flown"}
    assert notify(kite, flights=[flight])["refused_flights"] == [0]
    mission.refresh_from_db()
    assert (mission.state, mission.routes.get().flights_flown) == (MissionState.DISPATCHED, 0)


def test_a_computer_beside_an_autopilot_does_not_say_how_its_flights_end(mission: Mission, kite: UavClient) -> None:
    """Its token may be left from before; the gateway sees the flights."""
    kite.get("route")
    Uav.objects.update(link=LinkKind.MAVLINK)
    flight = {"approval": str(Approval.objects.get().pk), "flight": 1, "outcome": "failed"}
    reported = notify(kite, result(1, 0), flights=[flight])
    assert (reported["stored"], reported["refused_flights"]) == (1, [0])
    assert not mission.routes.get().has_failed
    UavLink.objects.filter(uav=kite.uav).update(mode="AUTO", is_in_air=True)
    assert kite.report(report(1, mode="Standby", is_in_air=False)).status_code == 200
    assert UavLink.objects.values_list("mode", "is_in_air").get(uav=kite.uav) == ("AUTO", True)
