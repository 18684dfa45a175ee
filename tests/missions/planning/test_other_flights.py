"""What other missions have in the air at the same time."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from missions.models import Mission, MissionState, Waypoint
from missions.selectors.flights import flights_at_the_same_time
from missions.services import create_mission, duplicate_mission, plan_mission
from planning.request import EndAction
from planning.rules import SeparationRules
from planning.separation.separation import conflicts
from tests.accounts.users import a_user
from tests.missions import worlds
from workspace.models import Organisation, Role

pytestmark = pytest.mark.django_db

DEPARTURE = datetime(2027, 5, 4, 9, 0, tzinfo=UTC)
FROM_S = DEPARTURE.timestamp()


def approved(ground: worlds.World, *, departs_at: datetime = DEPARTURE, end_action: EndAction = EndAction.RETURN, **changes) -> Mission:
    author = a_user(Role.OPERATOR)
    request = worlds.request(*ground.towers[:3], uavs=(worlds.uav(end_action=end_action),), departs_at=departs_at)
    draft = create_mission(organisation=author.organisation, author=author, name="Other", request=request)
    mission = plan_mission(mission=draft, actor=author)
    Mission.objects.filter(pk=mission.pk).update(**{"state": MissionState.APPROVED} | changes)
    mission.refresh_from_db()
    return mission


def test_a_flight_counts_its_seconds_from_the_window():
    mission = approved(worlds.world())
    found = flights_at_the_same_time(mission.organisation_id, FROM_S - 100.0, FROM_S + 10.0)
    [flight] = found.routes
    stored = mission.routes.get()
    assert (flight.uav, flight.mission, found.untimed) == ("Tern", str(mission.pk), ())
    assert flight.take_off_s == pytest.approx(100.0)
    assert flight.lands_s == pytest.approx(100.0 + stored.duration_s)
    arrival_s = np.array(list(stored.waypoints.values_list("arrival_s", flat=True)))
    assert flight.arrival_s == pytest.approx(100.0 + arrival_s, abs=0.2)
    assert np.isnan(flight.height_m).all()


def test_only_what_is_in_the_air_in_the_window_is_told():
    mission = approved(worlds.world())
    ends_s = FROM_S + mission.routes.get().duration_s
    assert flights_at_the_same_time(mission.organisation_id, FROM_S - 900.0, FROM_S).routes == ()
    assert flights_at_the_same_time(mission.organisation_id, ends_s, ends_s + 900.0).routes == ()
    assert len(flights_at_the_same_time(mission.organisation_id, ends_s - 1.0, ends_s + 900.0).routes) == 1


def test_a_hover_lasts_until_the_longest_flight_is_over(settings):
    mission = approved(worlds.world(), end_action=EndAction.HOVER)
    longest_s = settings.FLIGHT_RULES.longest_flight_s
    [flight] = flights_at_the_same_time(mission.organisation_id, FROM_S + longest_s - 1.0, FROM_S + longest_s).routes
    assert flight.lands_s == pytest.approx(1.0)
    assert flights_at_the_same_time(mission.organisation_id, FROM_S + longest_s, FROM_S + longest_s + 1.0).routes == ()


@pytest.mark.parametrize("state", [MissionState.PLANNED, MissionState.COMPLETED, MissionState.ABORTED, MissionState.FAILED])
def test_missions_that_are_not_to_be_flown_are_not_told(state):
    mission = approved(worlds.world(), state=state)
    assert flights_at_the_same_time(mission.organisation_id, FROM_S, FROM_S + 10.0).routes == ()


def test_neither_the_mission_itself_nor_deleted_ones_nor_those_of_others_are_told():
    ground = worlds.world()
    mission = approved(ground)
    deleted = approved(ground, deleted_at=DEPARTURE - timedelta(days=1))
    assert deleted.pk != mission.pk
    assert flights_at_the_same_time(mission.organisation_id, FROM_S, FROM_S + 10.0, but=mission.pk).routes == ()
    assert flights_at_the_same_time(Organisation.objects.create(name="Elsewhere").pk, FROM_S, FROM_S + 10.0).routes == ()


def test_a_flight_without_times_is_named_and_never_taken_as_away():
    mission = approved(worlds.world())
    Waypoint.objects.filter(route__mission=mission, sequence=1).update(arrival_s=None)
    found = flights_at_the_same_time(mission.organisation_id, FROM_S, FROM_S + 10.0)
    assert (found.routes, found.untimed) == ((), ((str(mission.pk), "Tern"),))


def test_a_mission_waits_until_an_approved_one_no_longer_hovers_in_its_way(settings):
    ground = worlds.world()
    first, second = (approved(ground, end_action=EndAction.HOVER) for _ in range(2))
    assert first.separation["delays"] == [0.0]
    assert second.separation["delays"][0] > settings.FLIGHT_RULES.longest_flight_s - first.routes.get().duration_s


def test_a_mission_that_lands_is_flown_after_an_approved_one_over_the_same_line():
    ground = worlds.world()
    first, second = approved(ground), approved(ground)
    assert second.separation["unresolved"] == []
    assert second.separation["delays"][0] > 0
    found = flights_at_the_same_time(first.organisation_id, FROM_S, FROM_S + 3_600.0)
    assert {flight.mission for flight in found.routes} == {str(first.pk), str(second.pk)}
    assert conflicts(found.routes, rules=SeparationRules()) == ()


def test_a_mission_that_is_put_off_by_hours_is_kept_apart_from_those_that_fly_then(settings):
    ground = worlds.world()
    hovering = approved(ground, end_action=EndAction.HOVER)
    later_at = DEPARTURE + timedelta(seconds=settings.FLIGHT_RULES.longest_flight_s)
    later = approved(ground, departs_at=later_at)
    put_off = approved(ground)
    assert hovering.pk != later.pk
    delays = put_off.separation["delays"]
    assert delays[0] > settings.FLIGHT_RULES.longest_flight_s - hovering.routes.get().duration_s
    found = flights_at_the_same_time(hovering.organisation_id, FROM_S, later_at.timestamp() + 7_200.0)
    assert conflicts(found.routes, rules=SeparationRules()) == ()


def test_a_mission_without_a_departure_is_named_and_never_taken_as_away():
    mission = approved(worlds.world(), departs_at=DEPARTURE)
    Mission.objects.filter(pk=mission.pk).update(departs_at=None)
    assert flights_at_the_same_time(mission.organisation_id, FROM_S, FROM_S + 10.0).untimed == ((str(mission.pk), "Tern"),)


def test_a_copy_of_an_approved_mission_is_told_that_it_flies_through_it():
    mission = approved(worlds.world())
    assert mission.separation["unresolved"] == []
    [found] = duplicate_mission(mission=mission, author=mission.author).separation["unresolved"]
    assert (found["code"], found["metres"], set(found["missions"])) == ("too_near", 0.0, {None, str(mission.pk)})


def test_a_copy_keeps_the_times_and_layers_that_keep_its_own_routes_apart():
    ground = worlds.world()
    mission = approved(ground, state=MissionState.PLANNED)
    copy = duplicate_mission(mission=mission, author=mission.author)
    assert copy.separation == mission.separation
