"""What is wished of a plan beyond its targets: ties, sensors, limits, locked runs, bases to land at; and whether that fits together."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

from django.utils.translation import gettext as _
from django.utils.translation import ngettext

from inspection.geodesy import LonLat
from missions.models import EndAction
from missions.selectors.fleet import bases_of_organisation
from missions.services.planning.requests import BaseRequest, InvalidRequest, LockRequest, PlanRequest, TargetRequest, UavRequest
from planning.problem import Objective
from workspace.models import Organisation


def with_bases(request: PlanRequest, organisation: Organisation) -> PlanRequest:
    """The request with the bases of today, if a UAV is to land at one. Raises InvalidRequest if there is none."""
    landing = [uav for uav in range(len(request.uavs)) if request.end_action(uav) is EndAction.BASE]
    if not landing:
        return replace(request, bases=())
    bases = stored_bases(organisation)
    if not bases:
        fault = _("%(uav)s is to land at a base, but there is none. Add one to the fleet, or choose another end.")
        raise InvalidRequest({f"uavs.{uav}.end_action": fault % {"uav": request.uavs[uav].name} for uav in landing})
    return replace(request, bases=bases)


def stored_bases(organisation: Organisation) -> tuple[BaseRequest, ...]:
    rows = bases_of_organisation(organisation).order_by("name", "pk")
    return tuple(BaseRequest(row.name, LonLat(*row.location.coords)) for row in rows)


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


def _faults(request: PlanRequest) -> Iterator[tuple[str, str]]:
    names = Counter(uav.name for uav in request.uavs)
    if request.objective is Objective.ENERGY:
        for number, uav in enumerate(request.uavs):
            if uav.performance.battery_wh is None:
                yield f"uavs.{number}.battery_wh", _("Without a battery %(uav)s has no energy to save.") % {"uav": uav.name}
    for number, uav in enumerate(request.uavs):
        if uav.sorties > 1 and request.end_action(number) is not EndAction.RETURN:
            yield f"uavs.{number}.sorties", _("%(uav)s can fly again only where it returns to its start.") % {"uav": uav.name}
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


def _name_fault(place: str, name: str, names: Counter[str]) -> Iterator[tuple[str, str]]:
    if not names[name]:
        yield place, _("There is no UAV named %(name)s in this plan.") % {"name": name}
    elif names[name] > 1:
        yield place, _("%(count)s UAVs of this plan are named %(name)s.") % {"count": names[name], "name": name}


def _target_faults(place: str, lock: LockRequest, taken: set[int], request: PlanRequest) -> Iterator[tuple[str, str]]:
    """taken: what the locks before it hold."""
    own: set[int] = set()
    uav = next((uav for uav in request.uavs if uav.name == lock.uav), None)
    for target in lock.targets:
        if not 0 <= target < len(request.targets):
            yield place, _("There is no target %(target)s.") % {"target": target}
        elif target in taken or target in own:
            yield place, _("Target %(target)s is locked twice.") % {"target": target}
        elif request.targets[target].uav not in ("", lock.uav):
            values = {"target": target, "uav": request.targets[target].uav}
            yield place, _("Target %(target)s is tied to %(uav)s, another UAV than it is locked to.") % values
        elif uav is not None and not has_sensor(uav, request.targets[target].sensor):
            values = {"target": target, "sensor": request.targets[target].sensor, "uav": lock.uav}
            yield place, _("Target %(target)s needs the sensor %(sensor)s, which %(uav)s does not have.") % values
        else:
            own.add(target)
            continue
        return


def _end_faults(locks: tuple[LockRequest, ...]) -> Iterator[tuple[str, str]]:
    for number, lock in enumerate(locks):
        others = [other for other in locks[:number] if other.uav == lock.uav]
        if lock.at_start and any(other.at_start for other in others):
            yield f"locks.{number}.at_start", _("%(uav)s has another locked run at its start.") % {"uav": lock.uav}
        if lock.at_end and any(other.at_end for other in others):
            yield f"locks.{number}.at_end", _("%(uav)s has another locked run at its end.") % {"uav": lock.uav}
        if any((lock.at_start and lock.at_end) or (other.at_start and other.at_end) for other in others):
            yield f"locks.{number}.uav", _("A locked run is all that %(uav)s flies: it has no place for another one.") % {"uav": lock.uav}


def _count_faults(request: PlanRequest) -> Iterator[tuple[str, str]]:
    for number, uav in enumerate(request.uavs):
        locked = sum(len(lock.targets) for lock in request.locks if lock.uav == uav.name)
        if uav.most_targets is not None and locked > uav.most_targets:
            fault = ngettext(
                "%(uav)s may do %(most)s target at most, but %(locked)s are locked to it.",
                "%(uav)s may do %(most)s targets at most, but %(locked)s are locked to it.",
                uav.most_targets,
            )
            yield f"uavs.{number}.most_targets", fault % {"uav": uav.name, "most": uav.most_targets, "locked": locked}
