"""Charging on the way: at which towers a UAV has to stop for how long, so that its battery never falls below the reserve.

A tower that is passed is a place to charge: the UAV comes down to it by the clearance that it keeps, charges, and rises again. The
battery takes the charger's power evenly up to full; what it takes less near full is not modelled, and no plan needs a full one but
where towers are far between.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.energy.conditions import Conditions
from planning.energy.leg_cost import J_PER_WH, Air, landing_taken, leg_taken, take_off_taken
from planning.energy.performance import Performance
from planning.rules import FlightRules
from planning.trajectory.timing import Timing
from planning.trajectory.waypoints import RoutePoints, Waypoints

HAIR_WH = 1e-9  # rounding


@dataclass(frozen=True)
class ChargingStop:
    """On arrival at a waypoint, before what is done there: down to the tower, `charging_s` there, and up again."""

    place: int  # of the waypoint
    charging_s: float
    charged_wh: float
    stopped_s: float  # with the way down and up
    used_wh: float  # for that way


class CannotCharge(ValueError):
    """Even with every stop the battery does not last: with `missing_wh` more it would. It ends first between these two waypoints.

    `start` is where it was charged last, -1 for the take-off; `end` the next tower, or the number of waypoints for the route's end.
    """

    def __init__(self, start: int, end: int, missing_wh: float) -> None:
        super().__init__(f"{missing_wh:.1f} Wh are missing; the battery ends between waypoint {start} and waypoint {end}.")
        self.start = start
        self.end = end
        self.missing_wh = missing_wh


class ChargerTooWeak(CannotCharge):
    """The charger gives no more than the UAV takes while it stands: what the route takes beyond the battery is missing."""


def places_over(points: RoutePoints, assets: Collection[int]) -> list[int]:
    """The places of the waypoints that pass or inspect these assets, in order; of supports, the towers to charge at."""
    return [int(place) for place in np.flatnonzero(np.isin(points.asset, np.array(sorted(assets), dtype=np.int64)))]


def charging_stops(
    waypoints: Waypoints,
    clock: Timing,
    *,
    towers: Sequence[int],
    tops_m: Sequence[float],
    charging_w: float,
    performance: Performance,
    conditions: Conditions,
    rules: FlightRules,
) -> tuple[ChargingStop, ...]:
    """As few stops as can be, and at each as little as is needed; none where the battery lasts.

    clock is the route's timing without stops; towers are the places of waypoints over towers, in order, tops_m how high above
    ground the UAV stands there. A UAV without a battery of known
    energy never has to stop. Raises CannotCharge, as ChargerTooWeak where the charger itself is why.
    """
    battery_wh, usable_wh = performance.battery_wh, performance.usable_wh
    if battery_wh is None or usable_wh is None or clock.used_wh is None or clock.total_wh is None or clock.total_wh <= usable_wh:
        return ()
    charges_w = charging_w - performance.avionics_w
    if charges_w <= 0.0:
        raise ChargerTooWeak(-1, len(waypoints), clock.total_wh - usable_wh)
    places = np.array(towers, dtype=np.int64)
    down, up = _way_to_towers(waypoints, places, tops_m, performance, conditions, rules)
    chosen = _fewest(clock.used_wh[places], clock.total_wh, down[:, 1], up[:, 1], usable_wh, places, len(waypoints))

    stops = []
    reserve_wh = battery_wh - usable_wh
    left_wh, last_wh = battery_wh, 0.0
    for number, tower in enumerate(chosen):
        here_wh = float(clock.used_wh[places[tower]])
        left_wh -= here_wh - last_wh + float(down[tower, 1])
        if number + 1 < len(chosen):
            onward = chosen[number + 1]
            next_wh = float(clock.used_wh[places[onward]]) + float(down[onward, 1])
        else:
            next_wh = clock.total_wh
        charged_wh = max(0.0, reserve_wh + float(up[tower, 1]) + next_wh - here_wh - left_wh)
        left_wh += charged_wh - float(up[tower, 1])
        last_wh = here_wh
        charging_s = charged_wh * J_PER_WH / charges_w
        way_s, way_wh = (float(down[tower, part] + up[tower, part]) for part in range(2))
        stops.append(ChargingStop(int(places[tower]), charging_s, charged_wh, charging_s + way_s, way_wh))
    return tuple(stops)


def with_stops(clock: Timing, stops: Sequence[ChargingStop], battery_wh: float) -> Timing:
    """The timing with the stops: everything after each is later, and the battery fuller. What is used counts, charged or not."""
    if not stops or clock.used_wh is None or clock.total_wh is None:
        return clock
    later_s, used_wh, charged_wh = (np.zeros(len(clock.arrival_s) + 1) for _ in range(3))
    for stop in stops:
        later_s[stop.place + 1 :] += stop.stopped_s
        used_wh[stop.place + 1 :] += stop.used_wh
        charged_wh[stop.place + 1 :] += stop.charged_wh
    used_wh[:-1] += clock.used_wh
    used_wh[-1] += clock.total_wh
    left_percent = 100.0 - (used_wh - charged_wh) * (100.0 / battery_wh)
    return replace(
        clock,
        arrival_s=clock.arrival_s + later_s[:-1],
        used_wh=used_wh[:-1],
        battery_left_percent=left_percent[:-1],
        total_s=clock.total_s + float(later_s[-1]),
        total_wh=float(used_wh[-1]),
        end_percent=float(left_percent[-1]),
    )


def _way_to_towers(
    waypoints: Waypoints,
    places: NDArray[np.int64],
    tops_m: Sequence[float],
    performance: Performance,
    conditions: Conditions,
    rules: FlightRules,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Seconds and Wh of the way down to each tower from above it, and of the way up again; (towers, 2) each."""
    air = Air.of(performance, rules.cruise_speed_mps, conditions, rules)
    down, up = np.empty((len(places), 2)), np.empty((len(places), 2))
    for number, place in enumerate(places.tolist()):
        agl_m = float(waypoints.points.agl_m[place])
        density = conditions.air_density(None if waypoints.amsl_m is None else float(waypoints.amsl_m[place]))
        low_m = min(tops_m[number], agl_m)
        touching, lifting = (
            landing_taken(agl_m + low_m, density, air),
            take_off_taken(agl_m + low_m, density, air),
        )  # half way between the two
        for way, start_m, end_m, besides in ((down, agl_m, low_m, touching), (up, low_m, agl_m, lifting)):
            seconds, joules = leg_taken(0.0, 0.0, 0.0, start_m, end_m, end_m - start_m, density, air)
            way[number] = seconds + besides[0], (joules + besides[1]) / J_PER_WH
    return down, up


def _least_usable_wh(arrives_wh: NDArray[np.float64], leaves_wh: NDArray[np.float64], total_wh: float) -> float:
    """What a battery has to give at least from one full charge to the next, with the best stops at towers in this order.

    arrives_wh: used by when it stands on each tower; leaves_wh: used as if it had been charged full while over it.
    """
    least_wh = np.maximum(arrives_wh, 0.0)  # to each tower
    for tower in range(1, len(least_wh)):
        over_wh = np.maximum(least_wh[:tower], arrives_wh[tower] - leaves_wh[:tower])
        least_wh[tower] = min(least_wh[tower], over_wh.min())
    return float(np.maximum(least_wh, total_wh - leaves_wh).min(initial=total_wh))


def _fewest(
    used_wh: NDArray[np.float64],
    total_wh: float,
    down_wh: NDArray[np.float64],
    up_wh: NDArray[np.float64],
    usable_wh: float,
    places: NDArray[np.int64],
    end: int,
) -> list[int]:
    """Towers, by number, of as few stops as can be: from each full battery on to the stop that leads farthest. Raises CannotCharge."""
    chosen: list[int] = []
    start_wh = 0.0  # what has been used when the battery was full last, with the way up from there
    while total_wh - start_wh > usable_wh + HAIR_WH:
        onward = np.arange(chosen[-1] + 1 if chosen else 0, len(places))
        is_near = used_wh[onward] + down_wh[onward] - start_wh <= usable_wh + HAIR_WH
        leads_to_wh = used_wh[onward] - up_wh[onward]
        is_near &= leads_to_wh > start_wh + HAIR_WH
        if not is_near.any():
            start = int(places[chosen[-1]]) if chosen else -1
            ahead = [tower for tower in onward.tolist() if used_wh[tower] + down_wh[tower] - start_wh > usable_wh + HAIR_WH]
            missing_wh = _least_usable_wh(used_wh + down_wh, used_wh - up_wh, total_wh) - usable_wh
            raise CannotCharge(start, int(places[ahead[0]]) if ahead else end, missing_wh)
        best = int(onward[is_near][leads_to_wh[is_near].argmax()])
        chosen.append(best)
        start_wh = float(used_wh[best] - up_wh[best])
    return chosen
