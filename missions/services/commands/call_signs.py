"""What distinguishes UAVs of several missions on live pages: the number before their letters, and their colours."""

from collections import Counter
from collections.abc import Sequence
from itertools import count

from django.db.models import Q
from django.utils import timezone

from missions.models import Mission, MissionState, MissionUav
from missions.selectors.events import SHOWN_AFTER_END
from workspace.leases import lock_until_end

CALL_NUMBERS_LOCK = 0x05A7_0032  # advisory lock, with the organisation
ROUTE_COLOURS = 8  # of static/css/tokens.css


def give_call_sign(mission: Mission) -> None:
    """Set the number and the colours of a mission that is sent to UAVs; the caller saves it. A lock serialises missions of an organisation.

    The number is the smallest that no other mission on the organisation's live pages has.
    """
    lock_until_end(CALL_NUMBERS_LOCK, mission.organisation_id)
    is_shown = Q(state__in=[MissionState.DISPATCHED, MissionState.ACTIVE]) | Q(ended_at__gt=timezone.now() - SHOWN_AFTER_END)
    others = Mission.objects.filter(is_shown, organisation=mission.organisation_id).exclude(pk=mission.pk)
    taken = set(others.values_list("call_number", flat=True))
    mission.call_number = next(number for number in count(1) if number not in taken)
    flown = MissionUav.objects.filter(route__geometry__isnull=False)
    shown = flown.filter(mission__in=others).order_by("mission__updated_at", "sequence").values_list("uav", "sequence", "mission__colours")
    own = flown.filter(mission=mission).order_by("sequence").values_list("sequence", "uav")
    mission.colours = colours_by_place(list(own), [(uav, colour_of(place, colours)) for uav, place, colours in shown])


def colour_of(place: int, colours: Sequence[int]) -> int:
    """Return the colour number of a UAV by its place in a mission with these colours, or with none yet."""
    return colours[place % ROUTE_COLOURS] if colours else place % ROUTE_COLOURS + 1


def colours_by_place(own: Sequence[tuple[int, int | None]], shown: Sequence[tuple[int | None, int]]) -> list[int]:
    """Return the colours of places 0 to 7 of a mission, numbers from 1; a ninth UAV has that of the first.

    own: places that fly, and their UAVs; shown: UAVs of other missions, and their colours. A UAV that is shown already keeps its colour.
    Another gets that of its place, or if another UAV has that one, the next one with the fewest uses.
    """
    flying = {place: uav for place, uav in own if place < ROUTE_COLOURS}
    known = {uav: colour for uav, colour in shown if uav is not None}
    ids = {uav for _place, uav in own if uav is not None}
    uses = Counter(colour for uav, colour in shown if uav not in ids)
    colours: dict[int, int] = {}

    def take(place: int, colour: int) -> None:
        colours[place] = colour
        uses[colour] += 1

    for place, uav in flying.items():
        if uav in known and known[uav] not in colours.values():
            take(place, known[uav])
    for place in flying:
        if place not in colours and not uses[place + 1]:
            take(place, place + 1)
    for place in sorted(range(ROUTE_COLOURS), key=lambda place: place not in flying):
        if place not in colours:
            take(place, min(range(1, ROUTE_COLOURS + 1), key=lambda colour: (uses[colour], (colour - place - 1) % ROUTE_COLOURS)))
    return [colours[place] for place in range(ROUTE_COLOURS)]
