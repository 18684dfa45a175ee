"""GET /api/v1/live: what a live page shows, and only what belongs to whoever asks."""

from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest
from django.utils import timezone

from missions.models import CommandKind, LinkKind, Mission, MissionUav, OfferState, ReplanOffer, Uav, UavCommand
from missions.services.commands.dispatch import dispatch_mission
from missions.services.commands.flight_progress import mark_started, mark_target
from missions.services.commands.refused import Refused
from missions.services.commands.steering import command_uav
from telemetry.models import Alert, AlertLevel, UavLink, UavWatch
from telemetry.selectors.live import MAX_CLOSED
from telemetry.serializers.live import LiveAnswerSerializer
from telemetry.services import store_records
from tests.accounts.users import a_user, client_of
from tests.missions.commands.outbox import a_uav, give
from tests.missions.flights import approved, carry, dispatched, fleet, ground
from tests.missions.worlds import world
from tests.telemetry.records import record
from workspace.models import Organisation

pytestmark = pytest.mark.django_db

KINDS = ("uavs", "missions", "alerts", "commands", "offers")


def asked(user: Any, query: str = "", **headers: str) -> Any:
    return client_of(user).get(f"/api/v1/live{query}", headers=headers)


def shown(user: Any, query: str = "") -> dict[str, list[dict[str, Any]]]:
    live: dict[str, list[dict[str, Any]]] = asked(user, query).json()["live"]
    return live


def test_what_flies_is_shown_as_it_is_described(tmp_path: Path) -> None:
    ground(tmp_path / "ground.tif")
    user, here, [uav] = a_user(), world(), fleet()
    mission = dispatched(user, [uav], [here.towers[3]])
    carry(uav)
    mark_started(mission_id=mission.pk, uav_id=uav.pk)
    mark_target(mission_id=mission.pk, target=0, state="complete")
    store_records([record(uav, 1, battery_percent=80.0, mode="AUTO")])
    UavLink.objects.update_or_create(uav=uav, defaults={"last_message_at": timezone.now(), "loaded_sha256": "a" * 64, "loaded_flight": 1})
    Alert.objects.create(uav=uav, mission=mission, level=AlertLevel.WARNING, code="link-late", message="Late", opened_at=timezone.now())
    ReplanOffer.objects.create(mission=mission, code="uav-out", state=OfferState.OPEN)
    answer = asked(user)
    live = answer.json()["live"]
    assert [len(live[kind]) for kind in KINDS] == [1, 1, 1, 1, 1]
    described = LiveAnswerSerializer(answer.json()).data
    assert {kind: set(entries[0]) for kind, entries in described["live"].items()} == {kind: set(live[kind][0]) for kind in KINDS}
    reported = live["uavs"][0]
    assert (reported["mission"], reported["place"], reported["link"]["loaded"]["flight"]) == (str(mission.pk), 0, 1)
    assert (reported["measured"]["battery_percent"], reported["measured"]["mode"], reported["measured"]["hdop"]) == (80.0, "AUTO", None)
    [target] = live["missions"][0]["targets"]
    assert (target["state"], target["uav"], live["missions"][0]["counts"]) == ("complete", 0, {"complete": 1, "all": 1})
    assert target["state_at"] is not None
    assert live["missions"][0]["started_at"] is not None


def test_a_report_is_late_when_alerts_call_it_late(tmp_path: Path) -> None:
    ground(tmp_path / "ground.tif")
    user, here, uavs = a_user(), world(), fleet("Kite", "Tern")
    mission = dispatched(user, uavs, [here.towers[3], here.bridge])
    carry(*uavs)
    kite, tern = uavs
    Uav.objects.filter(pk=tern.pk).update(link=LinkKind.HTTP)
    store_records([record(kite, 1), record(tern, 1)])
    UavWatch.objects.filter(uav=kite).update(estimated={"report_interval_s": 4.0})
    reported = {uav["name"]: uav["rhythm"] for uav in shown(user)["uavs"]}
    assert reported["Kite"] == {"interval_s": 4.0, "late_after_s": 10.0, "silent_after_s": 12.0}
    assert reported["Tern"] == {"interval_s": 10.0, "late_after_s": 25.0, "silent_after_s": 30.0}, "it was heard once, over HTTP"
    Mission.objects.filter(pk=mission.pk).update(alert_limits={"link_late_s": 15.0, "link_lost_s": 60.0})
    assert {uav["name"]: uav["rhythm"]["late_after_s"] for uav in shown(user)["uavs"]} == {"Kite": 15.0, "Tern": 25.0}


def test_only_what_goes_on_or_has_just_ended_is_shown() -> None:
    user, now = a_user(), timezone.now()
    for name, ended_ago in {"just ended": timedelta(minutes=59), "long over": timedelta(minutes=61)}.items():
        Mission.objects.create(name=name, ended_at=now - ended_ago)
    Mission.objects.create(name="deleted", ended_at=now, deleted_at=now)
    Mission.objects.create(name="a draft")
    received, silent = a_uav("heard"), a_uav("silent")
    UavLink.objects.create(uav=received, last_message_at=now - timedelta(hours=23))
    UavLink.objects.create(uav=silent, last_message_at=now - timedelta(hours=25))
    for code, closed_ago in {"closed": timedelta(minutes=59), "long closed": timedelta(minutes=61)}.items():
        facts = {"opened_at": now - timedelta(hours=3), "closed_at": now - closed_ago}
        Alert.objects.create(uav=received, level=AlertLevel.ADVISORY, code=code, message=code, **facts)
    done, old = give(received, CommandKind.HOLD), give(silent, CommandKind.HOLD)
    UavCommand.objects.filter(pk=done.pk).update(state="applied", finished_at=now - timedelta(minutes=9))
    UavCommand.objects.filter(pk=old.pk).update(state="applied", finished_at=now - timedelta(minutes=11))
    live = shown(user)
    names = {"uavs": "name", "missions": "name", "alerts": "code", "commands": "id"}
    assert {kind: [entry[name] for entry in live[kind]] for kind, name in names.items()} == {
        "uavs": ["heard"],
        "missions": ["just ended"],
        "alerts": ["closed"],
        "commands": [str(done.pk)],
    }


def test_of_alerts_that_were_closed_the_newest_are_shown_of_all_and_of_each_mission() -> None:
    user, uav, now = a_user(), a_uav("busy"), timezone.now()
    quiet, busy = Mission.objects.create(name="quiet"), Mission.objects.create(name="busy")
    facts = {"uav": uav, "level": AlertLevel.ADVISORY, "opened_at": now - timedelta(minutes=50)}
    Alert.objects.create(**facts, code="open", message="open", mission=busy)
    Alert.objects.create(**facts, code="calm", message="calm", mission=quiet, closed_at=now - timedelta(minutes=49))
    for number in range(MAX_CLOSED + 5):
        closed_at = now - timedelta(seconds=10 * number)
        Alert.objects.create(**facts, code=f"a{number}", message="over", mission=busy, closed_at=closed_at)
    newest = {"open", *(f"a{number}" for number in range(MAX_CLOSED))}
    assert {alert["code"] for alert in shown(user)["alerts"]} == newest
    assert {alert["code"] for alert in shown(user, f"?mission={busy.pk}")["alerts"]} == newest
    assert {alert["code"] for alert in shown(user, f"?mission={quiet.pk}")["alerts"]} == {"calm"}


def test_of_a_mission_only_what_belongs_to_it_is_shown_whatever_its_state() -> None:
    user, own, other = a_user(), a_uav("own"), a_uav("other")
    mission = Mission.objects.create(name="a draft")
    MissionUav.objects.create(mission=mission, uav=own, sequence=0, name="own", start=own.location, cruise_speed_mps=10.0)
    for uav in (own, other):
        UavLink.objects.create(uav=uav, last_message_at=timezone.now())
        Alert.objects.create(uav=uav, level=AlertLevel.WARNING, code="link-late", message="Late", opened_at=timezone.now())
        give(uav, CommandKind.HOLD)
    live = shown(user, f"?mission={mission.pk}")
    assert [uav["name"] for uav in live["uavs"]] == ["own"]
    assert [entry["name"] for entry in live["missions"]] == ["a draft"]
    assert [alert["uav"] for alert in live["alerts"]] == [command["uav"]["id"] for command in live["commands"]] == [own.pk]


def test_nothing_of_another_organisation_is_shown() -> None:
    elsewhere = Organisation.objects.create(name="Elsewhere")
    theirs = Mission.objects.create(name="theirs", organisation=elsewhere, ended_at=timezone.now())
    UavLink.objects.create(uav=a_uav("their UAV", elsewhere), last_message_at=timezone.now())
    user = a_user()
    assert shown(user) == {kind: [] for kind in KINDS}
    assert asked(user, f"?mission={theirs.pk}").status_code == 404
    assert asked(user, "?mission=7").status_code == 400


def test_while_nothing_changes_nothing_is_sent_again() -> None:
    user, uav = a_user(), a_uav("Tern")
    store_records([record(uav, 1)])
    etag = asked(user)["ETag"]
    again = asked(user, **{"If-None-Match": f"W/{etag}"})  # as it comes back through a proxy that packs
    assert (again.status_code, again.content, again["ETag"]) == (304, b"", etag)
    store_records([record(uav, 2)])
    assert asked(user, **{"If-None-Match": etag}).status_code == 200


def test_a_page_of_a_mission_shows_no_uav_that_has_no_route_of_it_or_flies_another() -> None:
    """South is planned for Tern and Kite, lists Crow without a route, and is sent to Tern alone; Kite and Crow fly North."""
    user, here = a_user(), world()
    tern, kite, crow = fleet("Tern", "Kite", "Crow")
    north = dispatched(user, [kite, crow], here.towers[1:3], name="North")
    carry(kite, crow)
    for uav in (kite, crow):
        command_uav(uav=uav, kind=CommandKind.START, actor=user, parameters={"out_of_slot": True})
        carry(uav)
    south, _approval = approved(user, [tern, kite], here.towers[1:3], name="South")
    with pytest.raises(Refused):
        dispatch_mission(mission=south, actor=user)
    assert [uav["name"] for uav in shown(user, f"?mission={south.pk}")["uavs"]] == ["Tern"]
    dispatch_mission(mission=south, actor=user, place=0)
    MissionUav.objects.create(mission=south, uav=crow, sequence=2, name="Crow", start=crow.location, cruise_speed_mps=10.0)
    [of_south] = shown(user, f"?mission={south.pk}")["missions"]
    assert [entry["name"] for entry in of_south["uavs"]] == ["Tern", "Kite"]
    assert [uav["name"] for uav in shown(user, f"?mission={south.pk}")["uavs"]] == ["Tern"]
    assert {uav["name"]: uav["mission"] for uav in shown(user)["uavs"]} == {
        "Tern": str(south.pk), "Kite": str(north.pk), "Crow": str(north.pk),
    }  # fmt: skip
    assert sorted(uav["name"] for uav in shown(user, f"?mission={north.pk}")["uavs"]) == ["Crow", "Kite"]
