"""Approving a mission freezes it; what speaks against that is said; and it is taken back."""

from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from django.utils import timezone
from hypothesis import given
from hypothesis import strategies as st

from inspection.geodesy import LonLat
from inspection.models import NoFlyZone
from mavlink.approved_route import route_from_json
from mavlink.legs import with_points_between
from mavlink.mission_items import flight_loads
from mavlink.mission_sync.limits import leg_warnings
from mavlink.vehicle_plan import load_from_json
from missions.models import Approval, CommandState, Mission, MissionState, TargetState, Uav, UavState, UavType
from missions.services import (
    MissionChange,
    MissionChanged,
    MissionFrozen,
    change_mission,
    change_route,
    delete_mission,
    duplicate_mission,
    plan_mission,
    take_back_change,
)
from missions.services.approval.approval import approve_mission, revoke_approval
from missions.services.approval.document import approval_document, content_sha256
from missions.services.commands.commands import note_applied, note_failed
from missions.services.commands.refused import Refused
from planning.clearance.lost_link import LostLink
from planning.request import LostLinkRequest
from tests.accounts.users import a_user, client_of
from tests.missions import worlds
from tests.missions.commands.outbox import claim, fence, now
from tests.missions.flights import an_operator, approved, carry, dispatched, fleet, ground, planned
from tests.missions.worlds import World
from workspace.models import Organisation, Role, User

pytestmark = pytest.mark.django_db

LATER = datetime(2027, 5, 4, 9, 0, tzinfo=UTC)


@pytest.fixture
def person() -> User:
    return an_operator()


def codes(error: pytest.ExceptionInfo[Refused]) -> list[str]:
    return [reason.code for reason in error.value.reasons]


def refused(mission: Mission, person: User) -> list[str]:
    with pytest.raises(Refused) as error:
        approve_mission(mission=mission, actor=person)
    assert Mission.objects.get(pk=mission.pk).state != MissionState.APPROVED
    assert not Approval.objects.filter(mission=mission).exists()
    return codes(error)


def test_an_approved_mission_has_a_document_that_its_hash_names(here: World, person: User) -> None:
    mission, approval = approved(person, fleet("Tern", "Kite"), here.towers[1:3])
    assert (mission.state, approval.approved_by, mission.revision) == (MissionState.APPROVED, person, 3)
    stored = Approval.objects.get(pk=approval.pk)
    assert content_sha256(stored.document) == stored.content_sha256 == approval.content_sha256
    routes = stored.document["routes"]
    assert [route["name"] for route in routes] == ["Tern", "Kite"]
    for route in routes:
        waypoints = mission.routes.get(mission_uav__sequence=route["place"]).waypoints.order_by("sequence")
        frozen = route_from_json(route["route"])
        assert [waypoint.position for waypoint in frozen.waypoints] == [row.position.coords for row in waypoints]
        (flight,) = route["flights"]
        assert load_from_json(flight["items"]).content_sha256 == flight["content_sha256"]
        assert flight["take_off"]["position"] == list(waypoints[0].position.coords)


def test_zones_beside_the_routes_are_frozen_with_what_they_say(here: World, person: User) -> None:
    zone = worlds.zone_around((10.015, 55.996), 0.0005, name="Airport")
    worlds.zone_around((11.0, 57.0), name="Far")
    _mission, approval = approved(person, fleet(), here.towers)
    (frozen,) = approval.document["zones"]
    assert (frozen["id"], frozen["name"], len(frozen["geometry_sha256"])) == (zone.pk, "Airport", 64)


def test_an_autopilot_keeps_out_of_zones_beside_its_route_and_knows_where_to_land(here: World, person: User) -> None:
    worlds.zone_around((10.012, 55.9985), 0.0005, name="Airport")
    high = worlds.zone_around((10.008, 55.9985), 0.0005, name="High")
    NoFlyZone.objects.filter(pk=high.pk).update(lower_limit_m=500.0, lower_reference="AGL")
    worlds.mark_ground_changed()
    back = LostLinkRequest(LostLink.RETURN, (LonLat(10.002, 55.996),))
    _mission, approval = approved(person, fleet(), [here.towers[0]], lost_link=back)
    (route,) = approval.document["routes"]
    (load,) = [load_from_json(flight["items"]) for flight in route["flights"]]
    assert len(load.fence) == 4
    assert {(round(item.longitude_e7 / 1e7, 4), round(item.latitude_e7 / 1e7, 4)) for item in load.fence} == {
        (10.0115, 55.998), (10.0125, 55.998), (10.0125, 55.999), (10.0115, 55.999),
    }  # fmt: skip
    assert [(item.longitude_e7, item.latitude_e7) for item in load.rally] == [(100_020_000, 559_960_000)]
    assert route["fence_left_out"] == []


def test_a_zone_saved_between_the_checks_and_the_document_is_not_approved(
    here: World, person: User, monkeypatch: pytest.MonkeyPatch
) -> None:
    mission = planned(person, fleet(), here.towers[1:2])

    def late(loaded: Mission, **more: Any) -> dict[str, Any]:
        worlds.zone_around((10.0025, 55.9975), 0.002, name="Saved meanwhile")
        return approval_document(loaded, **more)

    monkeypatch.setattr("missions.services.approval.approval.approval_document", late)
    assert refused(mission, person) == ["ground_changed"]


@pytest.mark.parametrize("change", ["patch", "plan", "delete", "by-hand", "undo"])
def test_an_approved_mission_is_frozen(here: World, person: User, change: str) -> None:
    mission, _approval = approved(person, fleet(), here.towers[:2])
    ways = {
        "patch": lambda: change_mission(mission=mission, actor=person, change=MissionChange(name="Other")),
        "plan": lambda: plan_mission(mission=mission, actor=person),
        "delete": lambda: delete_mission(mission=mission, actor=person),
        "by-hand": lambda: change_route(mission=mission, actor=person, uav=0, points=[]),
        "undo": lambda: take_back_change(mission=mission, actor=person, uav=0),
    }
    with pytest.raises(MissionFrozen):
        ways[change]()


def test_changes_of_the_fleet_do_not_reach_what_was_approved(here: World, person: User) -> None:
    uav_type = UavType.objects.create(name="Quad", cruise_speed_mps=12.0, range_unlimited=True)
    (tern,) = fleet(uav_type=uav_type)
    _mission, approval = approved(person, [tern], here.towers[:2])
    UavType.objects.update(cruise_speed_mps=3.0, max_range_m=10.0, range_unlimited=False)
    Uav.objects.update(name="Other", cruise_speed_mps=2.0, location=worlds.ground.Point(0, 0, srid=4326))
    stored = Approval.objects.get(pk=approval.pk)
    assert stored.document == approval.document
    assert content_sha256(stored.document) == approval.content_sha256


def test_a_draft_is_not_approved(here: World, person: User) -> None:
    mission = planned(person, fleet(), here.towers[:2])
    change_mission(mission=mission, actor=person, change=MissionChange(return_to_start=True))
    assert refused(mission, person) == ["not_planned"]


def test_nobody_approves_what_they_have_not_seen(here: World, person: User) -> None:
    mission = planned(person, fleet(), here.towers[:2])
    with pytest.raises(MissionChanged):
        approve_mission(mission=mission, actor=person, expected_revision=mission.revision - 1)


def test_a_mission_is_approved_once(here: World, person: User) -> None:
    mission, _approval = approved(person, fleet(), here.towers[:2])
    with pytest.raises(Refused) as error:
        approve_mission(mission=mission, actor=person)
    assert codes(error) == ["not_planned"]


def test_a_real_uav_is_not_approved_over_flat_ground(here: World, person: User) -> None:
    mission = planned(person, fleet("Tern", is_simulated=False), here.towers[:2])
    assert refused(mission, person) == ["flat_ground"]
    Uav.objects.update(is_simulated=True)
    assert approve_mission(mission=mission, actor=person)


def test_a_uav_of_no_fleet_counts_as_real(here: World, person: User) -> None:
    mission = planned(person, fleet(), here.towers[:2])
    mission.mission_uavs.update(uav=None)
    assert refused(mission, person) == ["flat_ground"]


def test_a_real_uav_is_approved_over_known_terrain(here: World, person: User, tmp_path: Path) -> None:
    ground(tmp_path / "hills.tif")
    mission = planned(person, fleet("Tern", is_simulated=False), here.towers[:2])
    approval = approve_mission(mission=mission, actor=person)
    (flight,) = approval.document["routes"][0]["flights"]
    assert flight["take_off"]["altitude_amsl_m"] == pytest.approx(100.0, abs=0.05)
    mission.refresh_from_db()


def test_a_waypoint_without_a_height_above_the_sea_is_none_for_a_real_uav(here: World, person: User, tmp_path: Path) -> None:
    ground(tmp_path / "hills.tif")
    mission = planned(person, fleet("Tern", is_simulated=False), here.towers[:2])
    mission.routes.get().waypoints.filter(sequence=1).update(altitude_amsl_m=None)
    assert "flat_ground" in refused(mission, person)


def test_ground_that_rose_since_is_refused(here: World, person: User, tmp_path: Path) -> None:
    ground(tmp_path / "hills.tif", 100.0)
    mission = planned(person, fleet("Tern", is_simulated=False), here.towers[:2])
    ground(tmp_path / "hills.tif", 123.0)
    assert "terrain_changed" in refused(mission, person)


def test_a_zone_that_a_route_meets_now_is_refused_and_one_elsewhere_is_not(here: World, person: User) -> None:
    mission = planned(person, fleet(), here.towers[:3])
    worlds.zone_around((11.0, 57.0), name="Far")
    approval = approve_mission(mission=mission, actor=person)
    assert approval.document["ground"]["revision"] > mission.ground_revision
    other = planned(person, fleet("Kite"), here.towers[:3], name="Other", departs_at=LATER)
    worlds.zone_around((10.008, 56.0), name="Airport")
    assert "zone" in refused(other, person)


def test_a_base_that_is_gone_is_refused(here: World, person: User) -> None:
    mission = planned(person, fleet(), here.towers[:2])
    mission.routes.update(lands_at=worlds.ground.Point(10.0, 56.0, srid=4326), base_name="North")
    assert refused(mission, person) == ["base_changed"]


def test_a_departure_that_is_over_is_refused(here: World, person: User) -> None:
    mission = planned(person, fleet(), here.towers[:2], departs_at=LATER)
    Mission.objects.filter(pk=mission.pk).update(departs_at=timezone.now() - timedelta(minutes=10))
    assert refused(mission, person) == ["departure_past"]


@pytest.mark.parametrize("facts", [{"battery_wh": 40.0}, {"reserve_percent": 40.0}, {"mass_kg": 3.0}, {"state": UavState.MAINTENANCE}])
def test_a_uav_that_changed_since_is_refused(here: World, person: User, facts: dict) -> None:
    (tern,) = fleet(battery_wh=1_000.0, mass_kg=1.545, reserve_percent=20.0, cruise_speed_mps=12.0)
    mission = planned(person, [tern], here.towers[:2])
    as_it_is = {"battery_wh": 1_000.0, "mass_kg": 1.545, "reserve_percent": 20.0, "max_airspeed_mps": None}
    mission.mission_uavs.update(performance=as_it_is)
    Uav.objects.update(**facts)
    assert refused(mission, person) == ["uav_changed"]
    Uav.objects.update(**as_it_is, state=UavState.ACTIVE)
    assert approve_mission(mission=mission, actor=person)


def test_two_missions_on_the_same_way_at_the_same_time_are_not_both_approved(here: World, person: User) -> None:
    first = planned(person, fleet("Tern"), here.towers[:3], name="First", departs_at=LATER)
    second = planned(person, fleet("Kite"), here.towers[:3], name="Second", departs_at=LATER)
    approve_mission(mission=first, actor=person)
    assert refused(second, person) == ["separation"]
    with pytest.raises(Refused, match="First"):
        approve_mission(mission=second, actor=person)


def test_a_route_that_charges_on_its_way_is_none_for_an_autopilot(here: World, person: User) -> None:
    mission = planned(person, fleet(), here.towers[:2])
    mission.routes.update(charging=[{"waypoint": 1, "stopped_s": 60.0, "charged_wh": 1.0}])
    assert refused(mission, person) == ["cannot_be_flown"]


def test_a_mission_in_which_nobody_flies_is_refused(here: World, person: User) -> None:
    mission = planned(person, fleet(), here.towers[:2])
    mission.routes.update(geometry=None)
    assert refused(mission, person) == ["no_routes"]


def test_a_revoked_mission_is_planned_again_and_its_approval_remembered(here: World, person: User) -> None:
    mission, approval = approved(person, fleet(), here.towers[:2])
    revoke_approval(mission=mission, actor=person, reason="Wrong day")
    mission.refresh_from_db()
    approval.refresh_from_db()
    assert (mission.state, approval.revoke_reason, approval.revoked_by) == (MissionState.PLANNED, "Wrong day", person)
    assert approval.revoked_at is not None
    change_mission(mission=mission, actor=person, change=MissionChange(name="Other"))
    again = approve_mission(mission=mission, actor=person)
    assert again.pk != approval.pk
    assert Approval.objects.filter(mission=mission).count() == 2


def test_what_is_planned_cannot_be_revoked(here: World, person: User) -> None:
    mission = planned(person, fleet(), here.towers[:2])
    with pytest.raises(Refused) as error:
        revoke_approval(mission=mission, actor=person, reason="Wrong day")
    assert codes(error) == ["not_approved"]


def test_uploads_that_never_left_are_dropped_with_the_approval(here: World, person: User) -> None:
    uavs = fleet("Tern", "Kite")
    mission = dispatched(person, uavs, here.towers[1:3])
    revoke_approval(mission=mission, actor=person, reason="Wrong day")
    mission.refresh_from_db()
    assert mission.state == MissionState.PLANNED
    assert {command.outcome_code for command in mission.commands.all()} == {"revoked"}
    assert claim(*uavs) == []


def test_an_approval_stays_until_every_uav_that_has_the_mission_was_seen_without_it(here: World, person: User) -> None:
    tern, kite = uavs = fleet("Tern", "Kite")
    mission = dispatched(person, uavs, here.towers[1:3])
    carry(tern)
    revoke_approval(mission=mission, actor=person, reason="Wrong day")
    mission.refresh_from_db()
    assert mission.state == MissionState.DISPATCHED
    assert claim(kite) == []
    (clear,) = claim(tern)
    assert clear.kind == "clear-mission"
    with pytest.raises(MissionFrozen):
        change_mission(mission=mission, actor=person, change=MissionChange(name="Other"))
    assert note_applied(clear.pk, **fence(clear))
    mission.refresh_from_db()
    assert mission.state == MissionState.PLANNED
    assert Approval.objects.get(mission=mission).revoked_by == person


def test_a_uav_that_was_being_sent_the_mission_may_have_a_part_of_it(here: World, person: User) -> None:
    (tern,) = uavs = fleet()
    mission = dispatched(person, uavs, here.towers[:2])
    (upload,) = claim(tern)
    revoke_approval(mission=mission, actor=person, reason="Wrong day")
    assert now(upload).state == CommandState.EXPIRED
    mission.refresh_from_db()
    assert mission.state == MissionState.DISPATCHED
    carry(tern)
    mission.refresh_from_db()
    assert mission.state == MissionState.PLANNED


def test_a_uav_that_failed_to_drop_it_is_told_again(here: World, person: User) -> None:
    (tern,) = uavs = fleet()
    mission = dispatched(person, uavs, here.towers[:2])
    carry(tern)
    revoke_approval(mission=mission, actor=person, reason="Wrong day")
    (clear,) = claim(tern)
    note_failed(clear.pk, "denied", "It flies.", **fence(clear))
    mission.refresh_from_db()
    assert mission.state == MissionState.DISPATCHED
    revoke_approval(mission=mission, actor=person, reason="Wrong day")
    assert [command.kind for command in carry(tern)] == ["clear-mission"]
    mission.refresh_from_db()
    assert mission.state == MissionState.PLANNED


def test_a_copy_of_an_approved_mission_is_planned_and_has_no_approval(here: World, person: User) -> None:
    mission, _approval = approved(person, fleet(), here.towers[:2])
    mission.targets.update(state=TargetState.COMPLETE)
    copy = duplicate_mission(mission=mission, author=person)
    assert (copy.state, copy.approvals.count()) == (MissionState.PLANNED, 0)


JSON = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**53), 2**53)
    | st.floats(-1e9, 1e9)
    | st.text(st.characters(exclude_characters="\0", codec="utf-8")),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text("abcdef", min_size=1, max_size=3), inner, max_size=4),
    max_leaves=12,
)


@given(JSON, JSON)
def test_another_content_has_another_hash(one: object, other: object) -> None:
    assert (content_sha256(one) == content_sha256(other)) == same(one, other)


def same(one: object, other: object) -> bool:
    """As values; a number is the same however it is written, and true is not 1."""
    if isinstance(one, bool) or isinstance(other, bool):
        return one is other
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(same, one, other))
    return type(one) is type(other) and one == other if not isinstance(one, int | float) else one == other


@given(JSON)
def test_the_database_keeps_what_the_hash_names(content: object) -> None:
    mission = Mission.objects.create(name="Kept", organisation_id=1)
    approval = Approval.objects.create(mission=mission, document={"content": content}, content_sha256=content_sha256({"content": content}))
    stored = Approval.objects.get(pk=approval.pk)
    assert content_sha256(stored.document) == approval.content_sha256
    mission.delete()


def test_every_leaf_of_a_real_document_counts(here: World, person: User) -> None:
    worlds.zone_around((10.015, 55.996), 0.0005)
    _mission, approval = approved(person, fleet("Tern", "Kite"), here.towers[1:3])
    seen = {approval.content_sha256}
    leaves = list(places(approval.document))
    assert len(leaves) > 100
    for place in leaves:
        changed = content_sha256(with_other(approval.document, place))
        assert changed not in seen
        seen.add(changed)


def places(value: object, place: tuple = ()) -> list[tuple]:
    if isinstance(value, dict) and value:
        return [leaf for key, entry in value.items() for leaf in places(entry, (*place, key))]
    if isinstance(value, list) and value:
        return [leaf for index, entry in enumerate(value) for leaf in places(entry, (*place, index))]
    return [place]


def with_other(value: object, place: tuple) -> object:
    if not place:
        return "changed" if value != "changed" else "otherwise"
    inner = {place[0]: with_other(value[place[0]], place[1:])}  # type: ignore[index]
    if isinstance(value, dict):
        return value | inner
    return [inner.get(index, entry) for index, entry in enumerate(value)]  # type: ignore[arg-type]


def test_points_are_put_in_where_wished_and_are_part_of_what_is_approved(here: World, person: User) -> None:
    mission = planned(person, fleet(), here.towers[:2])
    approval = approve_mission(mission=mission, actor=person, longest_leg_m=50.0)
    (route,) = approval.document["routes"]
    (flight,) = route["flights"]
    (plain,) = flight_loads(route_from_json(route["route"]))
    load = load_from_json(flight["items"])
    assert load.mission == with_points_between(plain, 50.0).mission != plain.mission
    assert load.content_sha256 == flight["content_sha256"]
    assert approval.document["longest_leg_m"] == 50.0
    assert leg_warnings(load, {"MIS_DIST_WPS": 50.0}, None) == ()
    assert leg_warnings(plain, {"MIS_DIST_WPS": 50.0}, None) != ()


def test_the_briefing_names_the_nearest_zone_that_the_flight_can_meet(here: World, person: User, tmp_path: Path) -> None:
    """A zone 111 m (0.001 degrees) south of the UAV's start; a nearer one begins far above the flight."""
    mission = planned(person, fleet(), [here.towers[0]])
    address = f"/api/v1/missions/{mission.pk}/nearest-zone"
    client = client_of(person)
    start = mission.mission_uavs.get().start.coords
    assert client.get(address).json() == {"nearest": None}
    near = worlds.zone_around((start[0], start[1] - 0.002), half_deg=0.001, name="Heliport")
    high = worlds.zone_around((start[0], start[1] - 0.001), half_deg=0.0005, name="Airway")
    NoFlyZone.objects.filter(pk=high.pk).update(lower_limit_m=600.0, lower_reference="AGL")
    worlds.rebuild()
    nearest = client.get(address).json()["nearest"]
    assert (nearest["id"], nearest["name"]) == (near.pk, "Heliport")
    assert nearest["metres"] == pytest.approx(111.3, abs=0.5)
    assert client_of(a_user(Role.OPERATOR, Organisation.objects.create(name="Other"))).get(address).status_code == 404
