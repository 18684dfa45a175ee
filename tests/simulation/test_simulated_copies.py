"""A mission of real UAVs flown by simulated twins in a copy of it: what the copy is, and that the mission stays as it is."""

from typing import Any

import pytest
from django.core import serializers
from django.test import Client
from django.utils import timezone

from missions.models import (
    Approval,
    CommandState,
    Mission,
    MissionState,
    MissionUav,
    Route,
    Uav,
    UavCommand,
    UavCredential,
    UavState,
    Waypoint,
)
from missions.selectors.flights import flights_at_the_same_time
from missions.services.approval.approval import approve_mission
from missions.services.commands.dispatch import dispatch_mission
from missions.services.commands.refused import Refused
from missions.services.commands.start_slots import reasons_to_wait
from missions.services.mission_copies import draft_follow_up, duplicate_mission
from simulation.models import SimulatedVehicle, Simulation
from simulation.services.idle_twins import end_copy, retire_idle_twins
from simulation.services.rehearsals import set_rule
from simulation.services.simulations import end_now
from tests.accounts.users import a_user, client_of
from tests.missions.api import patch, post
from tests.missions.commands.outbox import give
from tests.missions.flights import carry, fleet, ground, planned
from tests.missions.worlds import world
from workspace.models import Organisation, Role, User

pytestmark = pytest.mark.django_db


@pytest.fixture
def person() -> User:
    return a_user()


@pytest.fixture
def client(person: User) -> Client:
    return client_of(person)


@pytest.fixture
def real(person: User, tmp_path) -> Mission:
    """An approved mission of two real UAVs."""
    ground(tmp_path / "terrain.tif")
    uavs = fleet("Tern", "Kite", is_simulated=False, battery_percent=80.0)
    mission = planned(person, uavs, world().towers[:2])
    approve_mission(mission=mission, actor=person)
    return Mission.objects.get(pk=mission.pk)


def rows_of(mission: Mission) -> list[Any]:
    """All that is stored of a mission, its UAVs and what they were told."""
    uavs = Uav.objects.filter(mission_uavs__mission=mission)
    sets = [
        Mission.objects.filter(pk=mission.pk), MissionUav.objects.filter(mission=mission), mission.targets.all(), uavs,
        Route.objects.filter(mission=mission), Waypoint.objects.filter(route__mission=mission), Approval.objects.filter(mission=mission),
        UavCommand.objects.filter(uav__in=uavs), UavCredential.objects.filter(uav__in=uavs),
    ]  # fmt: skip
    return [serializers.serialize("python", rows.order_by("pk")) for rows in sets]


def flies_copy(client: Client, mission: Mission) -> Mission:
    answer = post(client, f"missions/{mission.pk}/simulated-copy", {"conditions": "calm"})
    assert answer.status_code == 201, answer.content
    return Mission.objects.get(pk=answer.json()["mission"])


def lines(mission: Mission) -> list[tuple[Any, ...]]:
    """The routes, without whose they are."""
    rows = Waypoint.objects.filter(route__mission=mission).order_by("route__mission_uav__sequence", "sequence")
    return [
        (*row, position.wkt)
        for *row, position in rows.values_list("kind", "task", "altitude_amsl_m", "altitude_relative_m", "arrival_s", "position")
    ]


def test_a_copy_has_the_same_routes_and_twins_of_the_uavs_and_the_mission_stays_as_it_is(client, person, real):
    before = rows_of(real)
    copy = flies_copy(client, real)
    assert rows_of(real) == before
    assert (copy.simulates_id, copy.state, copy.name, copy.departs_at) == (
        real.pk,
        MissionState.APPROVED,
        "Bexley spring (simulated)",
        None,
    )
    assert lines(copy) == lines(real)
    twins = [place.uav for place in copy.mission_uavs.select_related("uav")]
    assert [(twin.name, twin.is_simulated, twin.battery_percent) for twin in twins] == [
        ("Tern (simulated)", True, 100.0),
        ("Kite (simulated)", True, 100.0),
    ]
    assert copy.approvals.get().approved_by == person
    vehicles = SimulatedVehicle.objects.filter(simulation__mission=copy)
    assert {vehicle.uav_id for vehicle in vehicles} == {twin.pk for twin in twins}
    real_ids = set(Uav.objects.filter(is_simulated=False).values_list("mavlink_system_id", flat=True))
    assert not real_ids & {vehicle.system_id for vehicle in vehicles}
    dispatch_mission(mission=copy, actor=person)
    assert set(UavCommand.objects.values_list("uav", flat=True)) == {twin.pk for twin in twins}
    assert rows_of(real) == before
    assert client.get(f"/api/v1/missions/{copy.pk}").json()["simulates"] == str(real.pk)


def test_what_a_copy_missed_is_planned_for_the_uavs_themselves_as_the_mission_names_them(client, person, real):
    """Ties and ids are those of the mission, whatever the UAVs are called by now."""
    first, second = real.mission_uavs.order_by("sequence")
    real.targets.filter(sequence=0).update(uav_name=first.name, external_id="WO-1")
    Mission.objects.filter(pk=real.pk).update(external_id="Round 7")
    copy = flies_copy(client, real)
    twins = [place.name for place in copy.mission_uavs.order_by("sequence")]
    assert list(copy.targets.values_list("uav_name", "external_id")) == [(twins[0], ""), ("", "")]
    dispatch_mission(mission=copy, actor=person)
    end_copy(copy)
    Uav.objects.filter(pk=first.uav_id).update(name="Renamed")
    Uav.objects.filter(pk=second.uav_id).update(name=first.name)
    draft = draft_follow_up(mission=Mission.objects.get(pk=copy.pk), author=person)
    assert (draft.simulates, draft.external_id) == (None, "Round 7")
    assert list(draft.mission_uavs.values_list("uav", "name")) == [(first.uav_id, first.name), (second.uav_id, second.name)]
    assert list(draft.targets.values_list("uav_name", "external_id")) == [(first.name, "WO-1"), ("", "")]


@pytest.mark.long
def test_asked_again_the_same_copy_is_flown_and_twins_are_used_again(client, person, real):
    copy = flies_copy(client, real)
    assert flies_copy(client, real) == copy
    assert Simulation.objects.count() == 1
    end_now(Simulation.objects.get(), "ended-by-hand")
    assert flies_copy(client, real) == copy  # it can be flown still
    assert Simulation.objects.count() == 2
    for simulation in Simulation.objects.all():
        end_now(simulation, "ended-by-hand")
    Mission.objects.filter(pk=copy.pk).update(state=MissionState.COMPLETED, ended_at=timezone.now())
    other = flies_copy(client, real)
    assert other != copy
    assert list(other.mission_uavs.values_list("uav", flat=True)) == list(copy.mission_uavs.values_list("uav", flat=True))
    assert Uav.objects.filter(twin_of__isnull=False).count() == 2


def test_twins_of_copies_that_are_over_are_retired_and_come_back(client, person, real):
    copy = flies_copy(client, real)
    twins = Uav.objects.filter(twin_of__isnull=False)
    retire_idle_twins(organisation=real.organisation, actor=None)
    assert set(twins.values_list("state", flat=True)) == {UavState.ACTIVE}
    Mission.objects.filter(pk=copy.pk).update(state=MissionState.ABORTED, ended_at=timezone.now())
    end_now(Simulation.objects.get(), "mission-over")
    assert set(twins.values_list("state", "mavlink_system_id")) == {(UavState.RETIRED, None)}
    flies_copy(client, real)
    assert set(twins.values_list("state", flat=True)) == {UavState.ACTIVE}


def test_twins_are_not_offered_among_the_fleet_and_stay_simulated(real, client):
    flies_copy(client, real)
    administrator = client_of(a_user(Role.ADMINISTRATOR))
    listed = administrator.get("/api/v1/uavs").json()
    assert {uav["properties"]["name"] for uav in listed["features"]} == {"Tern", "Kite"}
    assert listed["numbers"]["active"] == 2
    twins = [uav for uav in administrator.get("/api/v1/uavs?twins=true").json()["features"] if uav["properties"]["twin_of"]]
    assert len(twins) == 2
    for change in ({"is_simulated": False}, {"link": "http"}, {"mavlink_system_id": 77}, {"allows_unsigned": True}):
        answer = patch(administrator, f"uavs/{twins[0]['id']}", change)
        assert (answer.status_code, answer.json()["error"]["code"]) == (409, "simulated_twin"), change
    answer = post(administrator, f"uavs/{twins[0]['id']}/credentials", {"kind": "mavlink-key"})
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "simulated_twin")


def test_a_twin_flies_in_copies_alone(client, person, real):
    """Separation leaves twins out: whatever else they are planned in is not approved, a duplicate of their copy neither."""
    copy = flies_copy(client, real)
    mission = planned(person, [place.uav for place in copy.mission_uavs.select_related("uav")], world().towers[:2], name="Another")
    for other in (mission, duplicate_mission(mission=copy, author=person)):
        with pytest.raises(Refused) as refused:
            approve_mission(mission=other, actor=person)
        assert "simulated_twin" in [reason.code for reason in refused.value.reasons]


@pytest.mark.long
def test_a_copy_ends_with_its_simulation(client, person, real):
    copy = flies_copy(client, real)
    dispatch_mission(mission=copy, actor=person)
    end_now(Simulation.objects.get(), "ended-by-hand")
    copy.refresh_from_db()
    assert copy.state == MissionState.ABORTED
    assert not UavCommand.objects.filter(mission=copy, state=CommandState.QUEUED).exists()
    assert set(Uav.objects.filter(twin_of__isnull=False).values_list("state", "mavlink_system_id")) == {(UavState.RETIRED, None)}
    real.refresh_from_db()
    assert real.state == MissionState.APPROVED


@pytest.mark.long
def test_a_copy_that_was_not_sent_is_flown_again_by_twins_that_come_back(client, person, real):
    copy = flies_copy(client, real)
    end_now(Simulation.objects.get(), "ended-by-hand")
    assert set(Uav.objects.filter(twin_of__isnull=False).values_list("state", flat=True)) == {UavState.RETIRED}
    assert flies_copy(client, real) == copy
    assert set(Uav.objects.filter(twin_of__isnull=False).values_list("state", flat=True)) == {UavState.ACTIVE}


@pytest.mark.long
def test_a_copy_is_in_nobodys_way(client, person, real):
    departs_at = timezone.now()
    copy = flies_copy(client, real)
    flights = flights_at_the_same_time(real.organisation_id, departs_at.timestamp(), departs_at.timestamp() + 3_600, but=real.pk)
    assert (flights.routes, flights.untimed) == ((), ())
    dispatch_mission(mission=copy, actor=person)
    twins = [place.uav for place in copy.mission_uavs.select_related("uav")]
    carry(*twins)
    give(twins[0], "start", mission=copy, approval=copy.approvals.get())
    tern = Uav.objects.get(name="Tern")
    route = Route.objects.select_related("mission", "mission_uav").get(mission=real, mission_uav__uav=tern)
    assert reasons_to_wait(uav=tern, route=route, flight=1, now=timezone.now()) == []


def test_who_may_not_fly_or_is_of_another_organisation_is_refused(client, person, real):
    path = f"missions/{real.pk}/simulated-copy"
    assert post(client_of(a_user(Role.VIEWER)), path).status_code == 403
    stranger = client_of(a_user(organisation=Organisation.objects.create(name="Others")))
    assert post(stranger, path).status_code == 404
    Mission.objects.filter(pk=real.pk).update(state=MissionState.PLANNED)
    assert post(client, path).json()["error"]["code"] == "not_approved"
    assert not Uav.objects.filter(twin_of__isnull=False).exists()


def test_a_copy_is_not_copied_and_its_page_leads_back(client, real):
    copy = flies_copy(client, real)
    assert post(client, f"missions/{copy.pk}/simulated-copy").json()["error"]["code"] == "is_copy"
    page = client.get(f"/missions/{copy.pk}/fly").content.decode()
    assert f"/missions/{real.pk}/fly" in page
    assert "flown by simulated twins" in page


@pytest.mark.parametrize("is_real", [False, True])
def test_a_copy_that_was_given_a_real_uav_needs_a_rehearsal_as_every_mission_does(client, person, real, is_real):
    copy = flies_copy(client, real)
    copy.approvals.all().delete()
    Mission.objects.filter(pk=copy.pk).update(state=MissionState.PLANNED)
    if is_real:
        place = copy.mission_uavs.order_by("sequence").first()
        MissionUav.objects.filter(pk=place.pk).update(uav=real.mission_uavs.get(sequence=place.sequence).uav)
    set_rule(organisation=person.organisation, actor=person, requires=True)
    copy.refresh_from_db()
    if is_real:
        with pytest.raises(Refused) as refused:
            approve_mission(mission=copy, actor=person)
        assert "not_rehearsed" in [reason.code for reason in refused.value.reasons]
    else:
        assert approve_mission(mission=copy, actor=person).mission_id == copy.pk
