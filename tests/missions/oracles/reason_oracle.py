"""Works out once more, for every UAV of a request, why a plan leaves a target out: by trying every order of the targets."""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise, permutations, product
from typing import Any

from missions.services import LockRequest, PlanRequest
from planning.problem import End
from tests.missions.property_tests.test_random_missions import MissionModel

METRES_OFF = 3.0  # what is kept in reserve of a range, and rounding
GROUNDED, NO_SENSOR, NO_WAY, RANGE = "cannot_take_off", "without_sensor", "no_permitted_route", "range_too_short"
BATTERY, NOTHING = "battery_too_small_of", "nothing"
BY_BATTERY = {"beyond_battery", "beyond_battery_as_drawn", "beyond_battery_with_charging"}
ALONE = {"in_range_alone", "in_reach_alone"}


class ReasonOracle:
    """Of one request without wind. models: the mission on the preferred and on the shortest ways."""

    def __init__(self, request: PlanRequest, models: Sequence[MissionModel]) -> None:
        self.request, self.models = request, models

    def untrue(self, plan: dict[str, Any]) -> Iterator[str]:
        for item in plan["unassigned"]:
            for fault in self._untrue(item):
                yield f"target {item['target']}: {fault}: {item['reason']}, {item['message']}"

    def _untrue(self, item: dict[str, Any]) -> Iterator[str]:
        target, codes, params = item["target"], [reason["code"] for reason in item["why"]], item["why"][0]["params"]
        bound = self._bound_to(target)
        limits = {uav.name: self._limit(number, target) for number, uav in enumerate(self.request.uavs) if bound in (None, uav.name)}
        if item["reason"] == "not_allowed":
            yield from self._untrue_wish(item["target"], item["why"], bound, limits)
            return
        is_of_run = codes[0] == "locked_to_unreachable" or "locked_run" in codes
        if item["reason"] not in {"beyond_range", "beyond_energy", "no_path"} or codes[0] == "no_path_to_base" or is_of_run:
            return
        named: dict[str, str] = {}
        if codes[0] == "beyond_range":
            named[params["uav"]] = RANGE
            yield from self._wrong_figures(item, params, limits)
        elif codes[0] in BY_BATTERY:
            named[params["uav"]] = BATTERY
        elif codes[0] == "no_path_for_uavs":
            named |= dict.fromkeys(params["uavs"], NO_WAY)
        elif codes[0] == "no_path":
            named |= dict.fromkeys(limits, NO_WAY)
        elif codes[0] in ALONE:
            if NOTHING not in limits.values():
                yield f"nobody could do it alone, but {limits}"
            return
        else:
            return
        stated = named | _others(item["why"])
        for name, limit in limits.items():
            if limit == NOTHING and stated.get(name) != BATTERY:
                yield f"{name} has the range and a way, but is said to have {stated.get(name)}"
            elif limit not in (NOTHING, stated.get(name)):
                yield f"{name}: {limit}, but is said to have {stated.get(name)}"
        if BATTERY in stated.values():
            for name in (name for name, limit in stated.items() if limit == BATTERY):
                if next(uav for uav in self.request.uavs if uav.name == name).performance.battery_wh is None:
                    yield f"{name} has no battery"

    def _untrue_wish(self, target: int, why: list[dict[str, Any]], bound: str | None, limits: dict[str, str]) -> Iterator[str]:
        number = next((number for number, uav in enumerate(self.request.uavs) if uav.name == bound), None)
        reported = {(reason["code"], reason["params"].get("uav")) for reason in why}
        if number is not None and not self._has_sensor(number, target):
            if ("tied_without_sensor", bound) not in reported:
                yield f"it does not say that {bound} lacks the sensor"
        elif bound is not None and limits[bound] == GROUNDED and ("uav_inside_zone", bound) not in reported:
            yield f"it does not say why {bound} cannot take off"
        if NOTHING in limits.values() or RANGE in limits.values():
            yield f"somebody may do it, {limits}"

    def _wrong_figures(self, item: dict[str, Any], stated: dict[str, Any], limits: dict[str, str]) -> Iterator[str]:
        needed_m, missing_m = stated["needed_m"], stated["missing_m"]
        lacks_m = {}
        for number, uav in enumerate(self.request.uavs):
            if limits.get(uav.name) == RANGE:
                lacks_m[uav.name] = self._needed_m(number, item["target"]) - (uav.max_range_m or 0.0)
        name = stated["uav"]
        if name not in lacks_m:
            yield f"not the range is what keeps {name}"
            return
        if abs(item["missing_m"] - lacks_m[name]) > METRES_OFF:
            yield f"{name} lacks {lacks_m[name]:.1f} m, not {item['missing_m']:.1f} m"
        if lacks_m[name] > min(lacks_m.values()) + METRES_OFF:
            yield f"{min(lacks_m, key=lambda one: lacks_m[one])} comes nearer"
        range_m = next(uav.max_range_m for uav in self.request.uavs if uav.name == name) or 0.0
        if abs(needed_m - missing_m - range_m) > 1.0 or abs(missing_m - item["missing_m"]) > 1.0:
            yield "its figures do not add up"

    def _bound_to(self, target: int) -> str | None:
        lock = self._lock_of(target)
        return lock.uav if lock else self.request.targets[target].uav or None

    def _lock_of(self, target: int) -> LockRequest | None:
        return next((lock for lock in self.request.locks if target in lock.targets), None)

    def _limit(self, uav: int, target: int) -> str:
        """Of a UAV with nothing else to do, its battery left aside."""
        if uav not in self.models[0].uavs:
            return GROUNDED
        if not self._has_sensor(uav, target):
            return NO_SENSOR
        needed_m = self._needed_m(uav, target)
        if math.isinf(needed_m):
            return NO_WAY
        return RANGE if needed_m > (self.request.uavs[uav].max_range_m or math.inf) else NOTHING

    def _has_sensor(self, uav: int, target: int) -> bool:
        wanted = self.request.targets[target].sensor
        return not wanted or wanted in self.request.uavs[uav].sensors

    def _needed_m(self, uav: int, target: int) -> float:
        return min(self._least_m(model, uav, target) for model in self.models)

    def _least_m(self, model: MissionModel, uav: int, target: int) -> float:
        """Over every order of targets that this UAV may fly, in which locked runs are whole."""
        start, least_m = model.uavs.index(uav), math.inf
        own = next((number for number, place in enumerate(model.open) if place.target == target), None)
        if own is None:
            return math.inf
        others = [number for number in range(len(model.open)) if number != own and self._may(uav, model.open[number].target)]
        visits = model.problem.visits_of_target()
        for count in range(len(others) + 1):
            for chosen in permutations([own, *others], count + 1):
                if own in chosen and self._keeps_runs([model.open[number].target for number in chosen], uav):
                    for order in product(*(visits[number] for number in chosen)):
                        least_m = min(least_m, _length_m(model, start, order))
        return least_m

    def _may(self, uav: int, target: int) -> bool:
        return self._bound_to(target) in (None, self.request.uavs[uav].name) and self._has_sensor(uav, target)

    def _keeps_runs(self, order: list[int], uav: int) -> bool:
        for lock in self.request.locks:
            flown = [target for target in order if target in lock.targets]
            if not flown:
                continue
            begin = order.index(flown[0])
            if lock.uav != self.request.uavs[uav].name or tuple(order[begin : begin + len(lock.targets)]) != lock.targets:
                return False
            if (lock.at_start and begin > 0) or (lock.at_end and begin + len(lock.targets) < len(order)):
                return False
        return True


def _length_m(model: MissionModel, start: int, order: Sequence[int]) -> float:
    ways, problem = model.ways, model.problem
    metres = float(ways.from_start_m[start, order[0]]) + sum(problem.visits[visit].length_m for visit in order)
    metres += sum(float(ways.between_m[left, right]) for left, right in pairwise(order))
    end = problem.uavs[start].end
    back = ways.to_start_m[order[-1], start] if end is End.RETURN else ways.to_base_m[order[-1]] if end is End.ANY_BASE else 0.0
    return metres + float(back)


def _others(why: list[dict[str, Any]]) -> dict[str, str]:
    limits = next((reason["params"]["limits"] for reason in why if reason["code"] == "other_uavs"), [])
    return {name: limit["code"] for limit in limits for name in limit["params"]["uavs"]}
