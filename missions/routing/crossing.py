"""Moves between and within routes that taking out and putting back does not find: tails, long segments and whole routes change places.

Each joins a target to one of its neighbours: 2-opt* (Potvin and Rousseau 1995), 2-opt and or-opt with segments of any length, which are
turned round together with the stretches in them.
"""

from numba import njit

from missions.routing.arcs import IntArray
from missions.routing.plan_state import Ground, Plan, RandomState, draw, draw_below

NEIGHBOURS = 12
LONGEST_SEGMENT = 40
EXCHANGE_SHARE = 0.1  # how often whole routes change their UAVs, or a tail goes to a UAV that does not fly


@njit(cache=True, nogil=True)
def pick(ground: Ground, plan: Plan, random: RandomState, longest: int) -> tuple[int, int, int, int]:
    """Two UAVs and the places of two neighbouring targets on their routes; the first UAV is -1 if nothing was found.

    The first target is of the route named, unless that is -1.
    """
    target = draw_below(random, len(plan.uav_of))
    if longest >= 0:
        target = ground.target[plan.visit[longest, draw_below(random, plan.size[longest])]]
    other = ground.near[target, draw_below(random, min(ground.near.shape[1], NEIGHBOURS + 1))]
    uav, other_uav = plan.uav_of[target], plan.uav_of[other]
    if uav < 0 or other_uav < 0 or target == other:
        return -1, -1, 0, 0
    if draw(random) < EXCHANGE_SHARE:
        other_uav = draw_below(random, len(plan.size))
        if other_uav == uav:
            return -1, -1, 0, 0
        if plan.size[other_uav] == 0:
            return uav, other_uav, plan.place[target] - 1, 0
        return uav, other_uav, -1, 0
    return uav, other_uav, plan.place[target], plan.place[other]


@njit(cache=True, nogil=True)
def cross(ground: Ground, plan: Plan, old: Plan, random: RandomState, uav: int, other_uav: int, place: int, other: int) -> None:
    """Change the routes of the two UAVs, of which `old` has copies. What follows from the visits is left to `settle`."""
    if uav != other_uav:
        if place < 0 or draw(random) < 0.4 or plan.size[other_uav] == 0:
            _exchange_tails(plan, old, uav, other_uav, place + 1, other)
        else:
            _move_segment(ground, plan, old, random, uav, other_uav, place, other)
    elif draw(random) < 0.5:
        first, last = min(place, other), max(place, other)
        if draw(random) < 0.5:
            _turn(ground, plan.visit[uav], old.visit[uav], first + 1, last + 1)
        else:
            _turn(ground, plan.visit[uav], old.visit[uav], first, last)
    else:
        _move_within(ground, plan, old, random, uav, place, other)


@njit(cache=True, nogil=True)
def _exchange_tails(plan: Plan, old: Plan, uav: int, other_uav: int, cut: int, other_cut: int) -> None:
    size, other_size = old.size[uav], old.size[other_uav]
    tail, other_tail = size - cut, other_size - other_cut
    plan.visit[uav, cut : cut + other_tail] = old.visit[other_uav, other_cut:other_size]
    plan.visit[other_uav, other_cut : other_cut + tail] = old.visit[uav, cut:size]
    plan.size[uav], plan.size[other_uav] = cut + other_tail, other_cut + tail


@njit(cache=True, nogil=True)
def _turn(ground: Ground, visit: IntArray, old: IntArray, first: int, end: int) -> None:
    for place in range(first, end):
        visit[place] = ground.twin[old[first + end - 1 - place]]


@njit(cache=True, nogil=True)
def _segment(random: RandomState, size: int, place: int) -> tuple[int, int]:
    """Where a segment with the place at one of its ends begins and ends."""
    length = 1 + draw_below(random, min(size, 3 if draw(random) < 0.5 else LONGEST_SEGMENT))
    if draw(random) < 0.5:
        return place, min(size, place + length)
    return max(0, place + 1 - length), place + 1


@njit(cache=True, nogil=True)
def _move_segment(ground: Ground, plan: Plan, old: Plan, random: RandomState, uav: int, other_uav: int, place: int, other: int) -> None:
    """A segment of the other route goes next to the place."""
    size, other_size = old.size[uav], old.size[other_uav]
    first, end = _segment(random, other_size, other)
    slot = place + (1 if draw(random) < 0.5 else 0)
    length = end - first
    plan.visit[uav, slot + length : size + length] = old.visit[uav, slot:size]
    _lay(ground, plan.visit[uav], slot, old.visit[other_uav], first, end, draw(random) < 0.5)
    plan.visit[other_uav, first : other_size - length] = old.visit[other_uav, end:other_size]
    plan.size[uav], plan.size[other_uav] = size + length, other_size - length


@njit(cache=True, nogil=True)
def _move_within(ground: Ground, plan: Plan, old: Plan, random: RandomState, uav: int, place: int, other: int) -> None:
    """A segment that ends at the other place goes next to the place, on the same route."""
    first, end = _segment(random, old.size[uav], other)
    if first <= place < end:
        return
    slot = place + (1 if draw(random) < 0.5 else 0)
    turned = draw(random) < 0.5
    length = end - first
    visit, was = plan.visit[uav], old.visit[uav]
    if slot <= first:
        visit[slot + length : end] = was[slot:first]
        _lay(ground, visit, slot, was, first, end, turned)
    else:
        visit[first : slot - length] = was[end:slot]
        _lay(ground, visit, slot - length, was, first, end, turned)


@njit(cache=True, nogil=True)
def _lay(ground: Ground, visit: IntArray, at: int, old: IntArray, first: int, end: int, turned: bool) -> None:
    for number in range(end - first):
        visit[at + number] = ground.twin[old[end - 1 - number]] if turned else old[first + number]
