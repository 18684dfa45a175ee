"""The colours of UAVs of several missions: each has one of its own as far as there are eight."""

import re
from datetime import timedelta
from pathlib import Path

import pytest
from django.utils import timezone

from missions.models import Mission
from missions.services.commands.call_signs import ROUTE_COLOURS, colour_of, colours_by_place
from tests.missions.flights import an_operator, dispatched, fleet
from tests.missions.worlds import world

TOKENS = Path(__file__).resolve().parents[3] / "static/css/tokens.css"


def own(*uavs: int) -> list[tuple[int, int | None]]:
    return list(enumerate(uavs))


def test_uavs_have_the_colours_of_their_places_where_no_others_fly():
    assert colours_by_place(own(11, 12, 13), []) == [1, 2, 3, 4, 5, 6, 7, 8]


def test_a_colour_that_another_uav_has_is_not_given_again_and_others_keep_theirs():
    assert colours_by_place(own(11, 12, 13), [(21, 1), (22, 2)])[:3] == [4, 5, 3]


def test_a_uav_that_is_shown_already_keeps_its_colour():
    assert colours_by_place(own(11, 12), [(11, 5), (21, 2)])[:2] == [5, 3]


def test_past_the_palette_the_least_used_colours_come_again():
    shown = [(20 + number, number % ROUTE_COLOURS + 1) for number in range(ROUTE_COLOURS)]
    assert colours_by_place(own(11, 12), [*shown, (40, 1)])[:2] == [2, 3], "one has 1 twice already"
    assert len(set(colours_by_place(own(*range(30, 46)), []))) == ROUTE_COLOURS


def test_the_same_missions_are_given_the_same_colours():
    shown = [(21, 3), (22, 1), (None, 8)]
    assert colours_by_place(own(11, 12, 13), shown) == colours_by_place(own(11, 12, 13), list(reversed(shown)))


def test_there_are_as_many_colours_in_the_style_sheet():
    found = {int(number) for number in re.findall(r"--route-(\d+):", TOKENS.read_text())}
    assert found == set(range(1, ROUTE_COLOURS + 1))


@pytest.mark.django_db
def test_uavs_of_two_missions_that_are_shown_have_different_colours_until_one_is_long_over():
    person, here = an_operator(), world()

    def sent(*names: str) -> Mission:
        mission = dispatched(person, fleet(*names), here.towers[1 : 1 + len(names)])
        mission.refresh_from_db()
        return mission

    def shown(mission: Mission) -> set[int]:
        return {colour_of(place, mission.colours) for place in range(mission.mission_uavs.count())}

    first, second = sent("Tern", "Kite"), sent("Crow", "Rook")
    assert shown(first) == {1, 2}
    assert not shown(first) & shown(second)
    Mission.objects.filter(pk=first.pk).update(state="aborted", ended_at=timezone.now() - timedelta(minutes=61))
    assert shown(sent("Knot")) == {1}
