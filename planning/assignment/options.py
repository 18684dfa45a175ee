"""What is asked of a plan beyond its targets: ties, sensors, limits, locked runs; and whether that fits together."""

from collections import Counter
from collections.abc import Iterator

from operation.reasons import Reason
from planning.problem import Objective
from planning.request import EndAction, InvalidRequest, LockRequest, PlanRequest, TargetRequest, UavRequest


def has_sensor(uav: UavRequest, sensor: str) -> bool:
    """Whether the UAV has it; capitals and blanks around do not count. No sensor at all is what every UAV has."""
    return not sensor.strip() or _plain(sensor) in map(_plain, uav.sensors)


def may_do(uav: UavRequest, target: TargetRequest) -> bool:
    """Whether neither the target's tie nor its sensor speaks against the UAV."""
    return target.uav in ("", uav.name) and has_sensor(uav, target.sensor)


def _plain(sensor: str) -> str:
    return sensor.strip().casefold()


def refuse_contradictions(request: PlanRequest) -> None:
    """Raises InvalidRequest with every wish that no plan could keep, by its place in the request."""
    faults = dict(_faults(request))
    if faults:
        raise InvalidRequest(faults)


def _faults(request: PlanRequest) -> Iterator[tuple[str, Reason]]:
    names = Counter(uav.name for uav in request.uavs)
    if request.objective is Objective.ENERGY:
        for number, uav in enumerate(request.uavs):
            if uav.performance.battery_wh is None:
                yield f"uavs.{number}.battery_wh", Reason("no_battery_to_save", {"uav": uav.name})
    for number, uav in enumerate(request.uavs):
        if uav.sorties > 1 and request.end_action(number) is not EndAction.RETURN:
            yield f"uavs.{number}.sorties", Reason("sorties_without_return", {"uav": uav.name})
    for number, target in enumerate(request.targets):
        if target.uav:
            yield from _name_fault(f"targets.{number}.uav", target.uav, names)
    taken: set[int] = set()
    for number, lock in enumerate(request.locks):
        yield from _name_fault(f"locks.{number}.uav", lock.uav, names)
        yield from _target_faults(f"locks.{number}.targets", lock, taken, request)
        taken.update(lock.targets)
    if all(names[lock.uav] == 1 for lock in request.locks):
        yield from _end_faults(request.locks)
        yield from _count_faults(request)


def _name_fault(place: str, name: str, names: Counter[str]) -> Iterator[tuple[str, Reason]]:
    if not names[name]:
        yield place, Reason("unknown_uav_name", {"name": name})
    elif names[name] > 1:
        yield place, Reason("ambiguous_uav_name", {"count": names[name], "name": name})


def _target_faults(place: str, lock: LockRequest, taken: set[int], request: PlanRequest) -> Iterator[tuple[str, Reason]]:
    """taken: what the locks before it hold."""
    own: set[int] = set()
    uav = next((uav for uav in request.uavs if uav.name == lock.uav), None)
    for target in lock.targets:
        if not 0 <= target < len(request.targets):
            yield place, Reason("unknown_target", {"target": target})
        elif target in taken or target in own:
            yield place, Reason("target_locked_twice", {"target": target})
        elif request.targets[target].uav not in ("", lock.uav):
            values = {"target": target, "uav": request.targets[target].uav}
            yield place, Reason("target_tied_elsewhere", values)
        elif uav is not None and not has_sensor(uav, request.targets[target].sensor):
            values = {"target": target, "sensor": request.targets[target].sensor, "uav": lock.uav}
            yield place, Reason("sensor_missing", values)
        else:
            own.add(target)
            continue
        return


def _end_faults(locks: tuple[LockRequest, ...]) -> Iterator[tuple[str, Reason]]:
    for number, lock in enumerate(locks):
        others = [other for other in locks[:number] if other.uav == lock.uav]
        if lock.at_start and any(other.at_start for other in others):
            yield f"locks.{number}.at_start", Reason("two_runs_at_start", {"uav": lock.uav})
        if lock.at_end and any(other.at_end for other in others):
            yield f"locks.{number}.at_end", Reason("two_runs_at_end", {"uav": lock.uav})
        if any((lock.at_start and lock.at_end) or (other.at_start and other.at_end) for other in others):
            yield f"locks.{number}.uav", Reason("run_is_whole_route", {"uav": lock.uav})


def _count_faults(request: PlanRequest) -> Iterator[tuple[str, Reason]]:
    for number, uav in enumerate(request.uavs):
        locked = sum(len(lock.targets) for lock in request.locks if lock.uav == uav.name)
        if uav.most_targets is not None and locked > uav.most_targets:
            values = {"uav": uav.name, "most": uav.most_targets, "locked": locked, "count": uav.most_targets}
            yield f"uavs.{number}.most_targets", Reason("too_many_locked", values)
