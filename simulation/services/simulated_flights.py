"""Simulated UAVs in place of a mission's UAVs: they connect to the gateway with the UAVs' system ids and keys."""

from collections.abc import Mapping, Sequence
from typing import Any

from django.contrib.gis.geos import Point
from django.db import transaction
from django.utils.translation import gettext as _

from missions.models import CredentialKind, LinkKind, Mission, MissionState, MissionUav, Uav
from missions.services.commands.refused import RefusalReason, Refused, refuse, refuse_for
from missions.services.fleet.credentials import make_credential
from missions.services.fleet.rows import SystemIdQuota
from missions.services.fleet.uavs import change_uav
from simulation.models import SimulatedAutopilotType, SimulatedVehicle, Simulation
from simulation.rehearsing.flying import RouteToFly
from simulation.rehearsing.weather_scenario import WeatherScenario, scenario_to_json
from simulation.services.fleet import StandIn
from simulation.services.plan_to_fly import plan_to_fly
from simulation.services.simulations import check_quota, hold_starts, lifetime_end, note_start
from simulation.vehicle_models import PRESENT
from workspace.models import User

FLOWN = (MissionState.APPROVED, MissionState.DISPATCHED, MissionState.ACTIVE)
MAX_SYSTEM_ID = 250  # higher ids are ground stations
LIFETIME_S = 4 * 3_600.0


def start_simulated_flights(
    *,
    mission: Mission,
    actor: User,
    scenario: WeatherScenario,
    speed: float = 1.0,
    autopilot_type: SimulatedAutopilotType = SimulatedAutopilotType.PX4,
    seed: int = 7,
    faults: Mapping[str, Any] | None = None,
) -> Simulation:
    """Start the simulation of a mission loaded by selectors.mission_of_organisation.

    Raises QuotaReached, and Refused with every reason: real UAVs are never replaced, for any user.
    """
    if mission.state not in FLOWN:
        raise refuse("not_approved", _("Only an approved mission is flown in simulation. Approve it first, or rehearse it."))
    plan = plan_to_fly(mission)
    places = {place.sequence: place for place in mission.mission_uavs.select_related("uav")}
    refuse_for([reason for route in plan.routes if (reason := _why_not(places[route.uav]))])
    with transaction.atomic():
        hold_starts()
        _refuse_flown(places, plan.routes)
        check_quota(mission.organisation, len(plan.routes))
        simulation = Simulation.objects.create(
            organisation=mission.organisation,
            mission=mission,
            speed=speed,
            seed=seed,
            lifetime_ends_at=lifetime_end(LIFETIME_S),
            created_by=actor,
        )
        for route, stand_in in zip(plan.routes, plan.stand_ins, strict=True):
            uav = places[route.uav].uav
            assert uav is not None  # noqa: S101 - checked by _why_not
            _vehicle(simulation, route, stand_in, reachable(uav, actor), scenario, autopilot_type).save()
        note_start(simulation, actor, speed=speed, uavs=len(plan.routes), faults=faults)
    return simulation


def reachable(uav: Uav, actor: User) -> Uav:
    """Return the UAV with a system id, and a key if it needs one, as a gateway requires. A generated key is not shown to any user."""
    if uav.mavlink_system_id is None:
        taken = set(Uav.objects.exclude(mavlink_system_id=None).values_list("mavlink_system_id", flat=True))
        free = next((number for number in range(1, MAX_SYSTEM_ID + 1) if number not in taken), None)
        if free is None:
            raise refuse("no_system_id", _("All MAVLink system ids are taken."))
        try:
            uav = change_uav(uav=uav, actor=actor, position=None, values={"mavlink_system_id": free}, by_simulation=True)
        except SystemIdQuota as error:
            raise refuse("no_system_id", _("Your organisation has no MAVLink system id left. Retire a UAV to free its id.")) from error
    has_key = uav.credentials.filter(kind=CredentialKind.MAVLINK_KEY, revoked_at=None).exists()
    if not has_key and not uav.allows_unsigned:
        make_credential(uav=uav, actor=actor, kind=CredentialKind.MAVLINK_KEY)
    return uav


def _why_not(place: MissionUav) -> RefusalReason | None:
    """Return why a UAV of a mission cannot be simulated."""
    uav, values = place.uav, {"uav": place.name}
    if uav is None:
        return RefusalReason("not_in_fleet", _("%(uav)s is not in the fleet: nothing is sent to it.") % values, place.sequence)
    if not uav.is_simulated:
        words = _("%(uav)s is a real UAV. Only UAVs that the fleet marks as simulated are flown in simulation.")
        return RefusalReason("real_uav", words % values, place.sequence)
    if uav.link != LinkKind.MAVLINK:
        return RefusalReason(
            "not_by_mavlink", _("%(uav)s is reached through a companion computer, not by MAVLink.") % values, place.sequence
        )
    return None


def _refuse_flown(places: Mapping[int, MissionUav], routes: Sequence[RouteToFly]) -> None:
    by_uav = {places[route.uav].uav_id: places[route.uav] for route in routes}
    flown = set(SimulatedVehicle.objects.filter(uav__in=list(by_uav), state__in=PRESENT).values_list("uav_id", flat=True))
    reasons = [
        RefusalReason("already_simulated", _("%(uav)s is already flown in simulation.") % {"uav": place.name}, place.sequence)
        for uav_id, place in by_uav.items()
        if uav_id in flown
    ]
    if reasons:
        raise Refused(reasons)


def _vehicle(
    simulation: Simulation,
    route: RouteToFly,
    stand_in: StandIn,
    uav: Uav,
    scenario: WeatherScenario,
    autopilot_type: SimulatedAutopilotType,
) -> SimulatedVehicle:
    """Return the vehicle, on the ground at the take-off of its approved route."""
    take_off = route.route.take_off
    return SimulatedVehicle(
        simulation=simulation,
        sequence=route.uav,
        uav=uav,
        name=uav.name,
        system_id=uav.mavlink_system_id or 0,
        autopilot_type=autopilot_type,
        airframe=stand_in.airframe,
        battery_wh=stand_in.battery_wh,
        position=Point(*take_off.position, srid=4326),
        ground_amsl_m=take_off.altitude_amsl_m,
        heading_deg=uav.heading_deg or 0.0,
        conditions=scenario_to_json(scenario),
    )
