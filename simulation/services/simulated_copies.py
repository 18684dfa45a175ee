"""Simulated copies of missions with real UAVs: the same routes, flown by simulated twins.

The mission, its UAVs and its approval are only read. A twin has its own MAVLink system id and key, so its commands reach no other vehicle.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from django.db import transaction
from django.utils.translation import gettext as _

from inspection.geodesy import LonLat
from missions.models import LinkKind, Mission, MissionUav, Uav, UavState
from missions.models.missions import MAX_NAME_LENGTH
from missions.selectors.missions import approval_in_force, mission_of_organisation
from missions.services.approval.approval import approve_mission
from missions.services.commands.refused import RefusalReason, refuse, refuse_for
from missions.services.fleet.uavs import change_uav, create_uav
from missions.services.mission_copies import duplicate_mission
from simulation.models import SimulatedAutopilotType, SimulatedVehicle, Simulation
from simulation.rehearsing.weather_scenario import WeatherScenario
from simulation.services.idle_twins import retire_idle_twins
from simulation.services.simulated_flights import FLOWN, start_simulated_flights
from simulation.vehicle_models import PRESENT
from workspace.models import User

TWIN_NAME_LENGTH = 84  # of its UAV's name, to leave room for the suffix
FIGURES = (
    "uav_type", "max_range_m", "cruise_speed_mps", "battery_wh", "mass_kg", "reserve_percent", "max_airspeed_mps", "heading_deg", "sensor",
    "end_action",
)  # fmt: skip


def fly_simulated_copy(
    *,
    mission: Mission,
    actor: User,
    scenario: WeatherScenario,
    speed: float = 1.0,
    autopilot_type: SimulatedAutopilotType = SimulatedAutopilotType.PX4,
    seed: int = 7,
    faults: Mapping[str, Any] | None = None,
) -> Simulation:
    """Return the simulation of an approved mission's copy: the one that already flies, or a new one, approved by `actor`.

    Raises QuotaReached, and Refused with every reason.
    """
    with transaction.atomic():
        held = Mission.objects.select_for_update(no_key=True).get(pk=mission.pk)
        if held.simulates_id is not None:
            raise refuse("is_copy", _("This mission is a simulated copy: start its UAVs on its own page."))
        if held.state not in FLOWN or approval_in_force(held) is None:
            raise refuse("not_approved", _("Only an approved mission is flown in simulation. Approve it first, or rehearse it."))
        copy = _copy_in_use(held)
        present = None if copy is None else copy.simulations.filter(state__in=PRESENT).first()
        if present is not None:
            return present
        places = list(held.mission_uavs.select_related("uav__uav_type"))
        refuse_for([reason for place in places if (reason := _why_not(place)) is not None])
        if copy is None:
            copy = _make_copy(held, places, actor)
        else:
            _bring_back_twins(copy, actor)
        loaded = mission_of_organisation(copy.organisation, copy.pk)
        return start_simulated_flights(
            mission=loaded, actor=actor, scenario=scenario, speed=speed, autopilot_type=autopilot_type, seed=seed, faults=faults
        )


def _copy_in_use(mission: Mission) -> Mission | None:
    """Return the newest copy of the present plan that can still be flown."""
    copies = mission.simulated_copies.filter(state__in=FLOWN, deleted_at=None, planned_at=mission.planned_at, continues=None)
    return copies.order_by("-created_at").first()


def _bring_back_twins(copy: Mission, actor: User) -> None:
    """Reactivate the twins of a copy whose simulation ended before it was sent to them."""
    for place in copy.mission_uavs.filter(uav__state=UavState.RETIRED).select_related("uav"):
        assert place.uav is not None  # noqa: S101 - by the filter
        change_uav(uav=place.uav, actor=actor, position=None, values={"state": UavState.ACTIVE})


def _make_copy(mission: Mission, places: Sequence[MissionUav], actor: User) -> Mission:
    twins = {place.sequence: _twin(place, actor) for place in places}
    retire_idle_twins(organisation=mission.organisation, actor=actor, but=[twin.pk for twin in twins.values()])
    name = _("{name} (simulated)").format(name=mission.name[: MAX_NAME_LENGTH - 20])
    copy = duplicate_mission(
        mission=mission, author=actor, name=name, simulates=mission, departs_at=None, external_id="", attributes={},
        is_demo=mission.is_demo,
    )  # fmt: skip
    copy.targets.update(external_id="", attributes={})
    names = {}
    for place in copy.mission_uavs.all():
        twin = twins[place.sequence]
        names[place.name] = twin.name
        place.uav, place.name = twin, twin.name
        place.save(update_fields=["uav", "name"])
    for name, twin_name in names.items():
        copy.targets.filter(uav_name=name).update(uav_name=twin_name)
    copy.locks = [lock | {"uav": names.get(lock["uav"], lock["uav"])} for lock in copy.locks]
    copy.save(update_fields=["locks"])
    approve_mission(mission=copy, actor=actor)
    return copy


def _why_not(place: MissionUav) -> RefusalReason | None:
    """Return why a UAV of a mission can have no twin."""
    values = {"uav": place.name}
    if place.uav is None:
        return RefusalReason("not_in_fleet", _("%(uav)s is not in the fleet: nothing is sent to it.") % values, place.sequence)
    if SimulatedVehicle.objects.filter(uav__twin_of=place.uav_id, state__in=PRESENT).exists():
        return RefusalReason("already_simulated", _("%(uav)s is already flown in simulation.") % values, place.sequence)
    return None


def _twin(place: MissionUav, actor: User) -> Uav:
    """Return the twin of a mission's UAV, with that UAV's present data, at its take-off in the mission."""
    uav = place.uav
    assert uav is not None  # noqa: S101 - checked by _why_not
    values = {name: getattr(uav, name) for name in FIGURES} | {"battery_percent": 100.0, "state": UavState.ACTIVE}
    position = LonLat(*place.start.coords[:2])
    twin = Uav.objects.filter(twin_of=uav).first()
    if twin is not None:
        return change_uav(uav=twin, actor=actor, position=position, values=values)
    fixed = {"name": _free_name(uav), "twin_of": uav, "is_simulated": True, "is_demo": uav.is_demo, "link": LinkKind.MAVLINK}
    return create_uav(organisation=uav.organisation, actor=actor, position=position, values=values | fixed)


def _free_name(uav: Uav) -> str:
    """Return an unused name: "Inspector 1 (simulated)", then "Inspector 1 (simulated 2)"."""
    stem = uav.name[:TWIN_NAME_LENGTH]
    taken = set(Uav.objects.filter(organisation=uav.organisation_id, name__startswith=stem).values_list("name", flat=True))
    name, number = _("{name} (simulated)").format(name=stem), 2
    while name in taken:
        name, number = _("{name} (simulated {number})").format(name=stem, number=number), number + 1
    return name
