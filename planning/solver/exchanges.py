"""Moves between and within routes that taking out and putting back does not find: tails, long segments and whole routes change places.

Each joins a target to one of its neighbours: 2-opt* (Potvin and Rousseau 1995), 2-opt and or-opt with segments of any length, which are
turned round together with the stretches in them. A move is measured first, and made only if it is wanted.
"""

from typing import NamedTuple

from numba import njit

from planning.problem import IntArray
from planning.solver.cost_matrices import NO_PATH_M
from planning.solver.plan_state import NO, YES, PlanState, RandomState, draw, draw_below
from planning.solver.problem_arrays import ProblemArrays

NEIGHBOURS = 12
MAX_SEGMENT_LENGTH = 40
SHORT_SEGMENT = 3
EXCHANGE_SHARE = 0.1  # how often whole routes change their UAVs, or a tail goes to a UAV that does not fly
APPENDED_SHARE = 0.5  # of these
NEAREST_SHARE = 0.5  # how often the neighbour is one of the nearest, rather than one that a short plan is likely to join
TAILS_SHARE = 0.4  # of the moves between routes
NONE, TAILS, SEGMENT, TURN, WITHIN = 0, 1, 2, 3, 4


class Move(NamedTuple):
    """What is to be done.

    TAILS    from `slot` on the UAV's route changes places with the other's from `first` on
    SEGMENT  first to end - 1 of the other's route go to `slot` of the UAV's, turned round or not
    TURN     first to end - 1 of the UAV's route are turned round
    WITHIN   first to end - 1 of the UAV's route go to `slot` of the same, turned round or not
    """

    kind: int
    uav: int
    other_uav: int
    slot: int
    first: int
    end: int
    is_turned: bool


class Measured(NamedTuple):
    """The routes of the UAV and of the other after a move; no way if it may not be made. For a move within a route the other is it, too."""

    length_m: float
    service_s: float
    done: int
    other_length_m: float
    other_service_s: float
    other_done: int


@njit(cache=True, nogil=True)
def draw_move(problem: ProblemArrays, plan: PlanState, random: RandomState, longest: int) -> Move:
    """A move that joins two neighbouring targets. The first is of the route named, unless that is -1."""
    nothing = Move(NONE, 0, 0, 0, 0, 0, False)
    target = draw_below(random, len(plan.uav_of))
    if longest >= 0:
        target = problem.target[plan.visit[longest, draw_below(random, plan.size[longest])]]
    near = problem.near if draw(random) < NEAREST_SHARE else problem.joined
    other_target = near[target, draw_below(random, min(near.shape[1], NEIGHBOURS + 1))]
    uav, other_uav = plan.uav_of[target], plan.uav_of[other_target]
    if uav < 0 or other_uav < 0 or target == other_target:
        return nothing
    place, other = plan.place[target], plan.place[other_target]
    if draw(random) < EXCHANGE_SHARE:
        other_uav = draw_below(random, len(plan.size))
        if other_uav == uav:
            return nothing
        if draw(random) < APPENDED_SHARE or plan.size[other_uav] == 0:
            return Move(TAILS, uav, other_uav, place, plan.size[other_uav], 0, False)
        return Move(TAILS, uav, other_uav, 0, 0, 0, False)
    if uav != other_uav:
        if draw(random) < TAILS_SHARE:
            return Move(TAILS, uav, other_uav, place + 1, other, 0, False)
        first, end = _segment(random, plan.size[other_uav], other)
        return Move(SEGMENT, uav, other_uav, place + draw_below(random, 2), first, end, draw(random) < 0.5)
    if draw(random) < 0.5:
        first, last = min(place, other), max(place, other)
        beyond = draw_below(random, 2)
        return Move(TURN, uav, uav, 0, first + beyond, last + beyond, True)
    first, end = _segment(random, plan.size[uav], other)
    slot = place + draw_below(random, 2)
    if first <= slot <= end:
        return nothing
    return Move(WITHIN, uav, uav, slot, first, end, draw(random) < 0.5)


@njit(cache=True, nogil=True)
def _segment(random: RandomState, size: int, place: int) -> tuple[int, int]:
    """Where a segment with the place at one of its ends begins and ends."""
    length = 1 + draw_below(random, min(size, SHORT_SEGMENT if draw(random) < 0.5 else MAX_SEGMENT_LENGTH))
    if draw(random) < 0.5:
        return place, min(size, place + length)
    return max(0, place + 1 - length), place + 1


@njit(cache=True, nogil=True)
def added_m(problem: ProblemArrays, plan: PlanState, move: Move) -> float:
    """Metres by which a move lengthens both routes together, whether or not it may be made."""
    uav, other_uav, first, end = move.uav, move.other_uav, move.first, move.end
    if move.kind == TAILS:
        size, other_size = plan.size[uav], plan.size[other_uav]
        before, behind = _around(plan, uav, move.slot, move.slot)
        other_before, other_behind = _around(plan, other_uav, first, first)
        longer_m = _joined_m(problem, uav, before, other_behind) + _joined_m(problem, other_uav, other_before, behind)
        longer_m -= plan.gap_m[uav, move.slot] + plan.gap_m[other_uav, first] * (other_size > 0)
        if problem.class_of[uav] != problem.class_of[other_uav]:
            tail_m, own_tail_m, _, _, _ = _carried(problem, plan, other_uav, uav, move.slot, size, NO)
            other_tail_m, own_other_tail_m, _, _, _ = _carried(problem, plan, uav, other_uav, first, other_size, NO)
            longer_m += own_tail_m - tail_m + own_other_tail_m - other_tail_m
        if behind >= 0:
            last = plan.visit[uav, size - 1]
            longer_m += problem.end_m[other_uav, last] - problem.end_m[uav, last]
        if other_behind >= 0:
            last = plan.visit[other_uav, other_size - 1]
            longer_m += problem.end_m[uav, last] - problem.end_m[other_uav, last]
        return float(longer_m)
    begin, last = plan.visit[other_uav, first], plan.visit[other_uav, end - 1]
    longer_m = 0.0
    if move.is_turned:
        begin, last = problem.reversed_visit[last], problem.reversed_visit[begin]
    if (move.is_turned and not problem.is_alike) or problem.class_of[uav] != problem.class_of[other_uav]:
        old_m, new_m, _, _, _ = _carried(problem, plan, uav, other_uav, first, end, move.is_turned)
        longer_m = new_m - old_m
    before, behind = _around(plan, other_uav, first, end)
    longer_m -= plan.gap_m[other_uav, first] + plan.gap_m[other_uav, end]
    if move.kind == TURN:
        return float(longer_m + _joined_m(problem, uav, before, begin) + _joined_m(problem, uav, last, behind))
    left, right = _around(plan, uav, move.slot, move.slot)
    longer_m += _joined_m(problem, other_uav, before, behind) - plan.gap_m[uav, move.slot]
    return float(longer_m + _joined_m(problem, uav, left, begin) + _joined_m(problem, uav, last, right))


@njit(cache=True, nogil=True)
def measured(problem: ProblemArrays, plan: PlanState, move: Move) -> Measured:
    uav, other_uav = move.uav, move.other_uav
    length_m, service_s, done = plan.length_m[uav], plan.service_s[uav], plan.done[uav]
    if move.kind == TAILS:
        return _with_other_tails(problem, plan, move)
    old_m, new_m, moved_s, moved, may = _carried(problem, plan, uav, other_uav, move.first, move.end, move.is_turned)
    if not may:
        return Measured(NO_PATH_M, service_s, done, NO_PATH_M, service_s, done)
    before, behind = _around(plan, other_uav, move.first, move.end)
    begin, last = plan.visit[other_uav, move.first], plan.visit[other_uav, move.end - 1]
    if move.is_turned:
        begin, last = problem.reversed_visit[last], problem.reversed_visit[begin]
    if move.kind == TURN:
        length_m += _joined_m(problem, uav, before, begin) + new_m + _joined_m(problem, uav, last, behind)
        length_m -= plan.gap_m[uav, move.first] + old_m + plan.gap_m[uav, move.end]
        return Measured(length_m, service_s, done, length_m, service_s, done)
    left, right = _around(plan, uav, move.slot, move.slot)
    added_m = _joined_m(problem, uav, left, begin) + new_m + _joined_m(problem, uav, last, right)
    if plan.size[uav]:
        added_m -= plan.gap_m[uav, move.slot]
    removed_m = plan.gap_m[other_uav, move.first] + old_m + plan.gap_m[other_uav, move.end] - _joined_m(problem, other_uav, before, behind)
    if move.kind == WITHIN:
        length_m += added_m - removed_m
        return Measured(length_m, service_s, done, length_m, service_s, done)
    return Measured(
        length_m + added_m,
        service_s + moved_s,
        done + moved,
        plan.length_m[other_uav] - removed_m,
        plan.service_s[other_uav] - moved_s,
        plan.done[other_uav] - moved,
    )


@njit(cache=True, nogil=True)
def _with_other_tails(problem: ProblemArrays, plan: PlanState, move: Move) -> Measured:
    uav, other_uav, cut, other_cut = move.uav, move.other_uav, move.slot, move.first
    size, other_size = plan.size[uav], plan.size[other_uav]
    _, tail_m, tail_s, tail, may = _carried(problem, plan, other_uav, uav, cut, size, NO)
    _, other_tail_m, other_tail_s, other_tail, other_may = _carried(problem, plan, uav, other_uav, other_cut, other_size, NO)
    if not (may and other_may):
        return Measured(NO_PATH_M, 0.0, 0, NO_PATH_M, 0.0, 0)
    before, behind = _around(plan, uav, cut, cut)
    other_before, other_behind = _around(plan, other_uav, other_cut, other_cut)
    length_m = _joined_m(problem, uav, before, other_behind) + other_tail_m
    other_length_m = _joined_m(problem, other_uav, other_before, behind) + tail_m
    for place in range(cut):
        length_m += plan.gap_m[uav, place]
    for place in range(other_cut):
        other_length_m += plan.gap_m[other_uav, place]
    if other_cut < other_size:
        length_m += problem.end_m[uav, plan.visit[other_uav, other_size - 1]]
    if cut < size:
        other_length_m += problem.end_m[other_uav, plan.visit[uav, size - 1]]
    return Measured(
        length_m,
        plan.service_s[uav] - tail_s + other_tail_s,
        plan.done[uav] - tail + other_tail,
        other_length_m,
        plan.service_s[other_uav] - other_tail_s + tail_s,
        plan.done[other_uav] - other_tail + tail,
    )


@njit(cache=True, nogil=True)
def _carried(
    problem: ProblemArrays, plan: PlanState, to_uav: int, uav: int, first: int, end: int, is_turned: bool
) -> tuple[float, float, float, int, bool]:
    """Metres inside a segment as it is and as the UAV that gets it would fly it, its service and targets, and whether that one may."""
    visit, gap_m, usable = plan.visit[uav], plan.gap_m[uav], problem.usable[to_uav]
    old_m, new_m, service_s, done = 0.0, 0.0, 0.0, 0
    number, is_same = problem.class_of[to_uav], problem.class_of[to_uav] == problem.class_of[uav]
    is_new = not is_same or (is_turned and not problem.is_alike)
    for place in range(first, end):
        here = visit[place]
        service_s += problem.service_s[here]
        done += problem.done[here]
        if is_turned:
            here = problem.reversed_visit[here]
            if place > first and is_new:
                new_m += problem.onward_m[number, here, problem.reversed_visit[visit[place - 1]]]
        elif place > first and is_new:
            new_m += problem.onward_m[number, visit[place - 1], here]
        if place > first:
            old_m += gap_m[place]
        if not usable[here]:
            return 0.0, 0.0, 0.0, 0, False
    return old_m, new_m if is_new else old_m, service_s, done, True


@njit(cache=True, nogil=True, inline="always")
def _around(plan: PlanState, uav: int, first: int, end: int) -> tuple[int, int]:
    """The visits before and behind a segment; -1 for the start and the end of the route."""
    before = plan.visit[uav, first - 1] if first > 0 else -1
    behind = plan.visit[uav, end] if end < plan.size[uav] else -1
    return before, behind


@njit(cache=True, nogil=True, inline="always")
def _joined_m(problem: ProblemArrays, uav: int, left: int, right: int) -> float:
    if left < 0:
        return float(problem.first_m[uav, right]) if right >= 0 else 0.0
    return float(problem.onward_m[problem.class_of[uav], left, right]) if right >= 0 else float(problem.end_m[uav, left])


@njit(cache=True, nogil=True)
def make(problem: ProblemArrays, plan: PlanState, old: PlanState, move: Move) -> None:
    """Change the routes of the two UAVs, of which `old` has copies. What follows from the visits is left to `settle`."""
    uav, other_uav, first, end = move.uav, move.other_uav, move.first, move.end
    if move.kind == TAILS:
        _exchange_tails(plan, old, uav, other_uav, move.slot, first)
    elif move.kind == SEGMENT:
        size, other_size, slot, length = old.size[uav], old.size[other_uav], move.slot, end - first
        plan.visit[uav, slot + length : size + length] = old.visit[uav, slot:size]
        _lay(problem, plan.visit[uav], slot, old.visit[other_uav], first, end, move.is_turned)
        plan.visit[other_uav, first : other_size - length] = old.visit[other_uav, end:other_size]
        plan.size[uav], plan.size[other_uav] = size + length, other_size - length
    elif move.kind == TURN:
        _lay(problem, plan.visit[uav], first, old.visit[uav], first, end, YES)
    elif move.kind == WITHIN:
        _move_within(problem, plan.visit[uav], old.visit[uav], move)


@njit(cache=True, nogil=True)
def _exchange_tails(plan: PlanState, old: PlanState, uav: int, other_uav: int, cut: int, other_cut: int) -> None:
    size, other_size = old.size[uav], old.size[other_uav]
    tail, other_tail = size - cut, other_size - other_cut
    plan.visit[uav, cut : cut + other_tail] = old.visit[other_uav, other_cut:other_size]
    plan.visit[other_uav, other_cut : other_cut + tail] = old.visit[uav, cut:size]
    plan.size[uav], plan.size[other_uav] = cut + other_tail, other_cut + tail


@njit(cache=True, nogil=True)
def _move_within(problem: ProblemArrays, visit: IntArray, old: IntArray, move: Move) -> None:
    slot, first, end = move.slot, move.first, move.end
    length = end - first
    if slot <= first:
        visit[slot + length : end] = old[slot:first]
        _lay(problem, visit, slot, old, first, end, move.is_turned)
    else:
        visit[first : slot - length] = old[end:slot]
        _lay(problem, visit, slot - length, old, first, end, move.is_turned)


@njit(cache=True, nogil=True)
def _lay(problem: ProblemArrays, visit: IntArray, at: int, old: IntArray, first: int, end: int, is_turned: bool) -> None:
    for number in range(end - first):
        visit[at + number] = problem.reversed_visit[old[end - 1 - number]] if is_turned else old[first + number]
