"""Commands of a user to one UAV: what is possible in its state, and with which values."""

from datetime import datetime, timedelta
from typing import Any

from django.conf import settings
from django.db import transaction
from django.utils import timezone
from django.utils.translation import gettext as _

from mavlink.rtl import rtl_behaviour
from missions.command_rules import ALONG_ROUTE, HEIGHT_M, SETS_IN_MOTION, THEN_RETURN, WAIT_S
from missions.hooks.in_air import uavs_down_off_plan
from missions.models import (
    Approval,
    CommandKind,
    CommandState,
    LinkKind,
    Mission,
    MissionState,
    MissionUav,
    Route,
    Uav,
    UavCommand,
    UavState,
)
from missions.selectors.commands import route_commands, upload_of
from missions.selectors.fleet import performance_of
from missions.selectors.missions import approval_in_force
from missions.services.approval.checks import ApprovalCheck, check_approval, incomplete_reasons, valid_check
from missions.services.commands.flight_progress import ON_ITS_WAY
from missions.services.commands.outbox import queue_command
from missions.services.commands.refused import RefusalReason, refuse, refuse_for
from missions.services.commands.staggered_returns import return_in_steps
from missions.services.commands.start_slots import OUT_OF_SLOT, hold_starts, reasons_to_wait
from workspace.models import User

MIN_SPEED_MPS = 0.5
MIN_TAKE_OFF_M = 1.0
MAX_WAIT_S = 900.0  # before a return
FROM_THE_GROUND = frozenset({CommandKind.ARM, CommandKind.TAKE_OFF, CommandKind.START})
BY_HAND = tuple(kind for kind in CommandKind if kind not in {CommandKind.UPLOAD_MISSION, CommandKind.CLEAR_MISSION})


def command_uav(*, uav: Uav, kind: CommandKind, actor: User, why: str = "", parameters: dict[str, Any] | None = None) -> UavCommand:
    """Give one UAV a command, as part of its current mission if there is one.

    parameters: `speed_mps` over ground for a change of speed, `altitude_relative_m` above the take-off for a take-off, `out_of_slot` for a
    start although others in the air are near its route, `height_m` above the take-off for a return height, with `then_return` where it is
    to return at that. For a return `wait_s`, which it holds before, `height_m`, which is set before, or `along_route`. Raises Refused.
    """
    if kind not in BY_HAND:
        raise refuse("not_by_hand", _("Missions are sent and taken back with the whole mission."))
    if uav.state == UavState.RETIRED:
        raise refuse("uav_not_in_service", _("%(uav)s is retired.") % {"uav": uav.name})
    checked = _parameters(uav, kind, parameters or {})
    mission = mission_in_hand(uav)
    check = check_approval(mission, now=timezone.now()) if mission is not None and kind == CommandKind.START else None
    with transaction.atomic():
        if mission is not None and kind in SETS_IN_MOTION:  # stopping a UAV does not wait for the lock of its mission
            mission = Mission.objects.select_for_update(no_key=True).get(pk=mission.pk)
        approval = None if mission is None else approval_in_force(mission)
        if kind in SETS_IN_MOTION:
            mission, approval = _to_move_for(uav, kind, mission, approval)
            if kind == CommandKind.START:
                checked["flight"] = _flight_to_start(uav, mission, approval, check, timezone.now(), out_of_slot=OUT_OF_SLOT in checked)
        about = {"mission": mission, "approval": approval}
        if THEN_RETURN in checked or (kind == CommandKind.RETURN and checked.keys() & {WAIT_S, HEIGHT_M}):
            return return_in_steps(uav=uav, parameters=checked, actor=actor, why=why, **about)
        if ALONG_ROUTE in checked and approval is None:
            raise refuse("no_mission", _("%(uav)s has no mission.") % {"uav": uav.name})
        return queue_command(uav=uav, kind=kind, actor=actor, why=why, parameters=checked, mission=mission, approval=approval)


def mission_in_hand(uav: Uav) -> Mission | None:
    """Return the dispatched or active mission in which it flies a route: the one sent to it last, else the newest that plans one."""
    missions = list(
        Mission.objects.filter(
            deleted_at=None,
            state__in=ON_ITS_WAY,
            mission_uavs__uav=uav,
            mission_uavs__route__geometry__isnull=False,
            mission_uavs__route__continued_by=None,
        ).order_by("-updated_at")
    )
    sent = route_commands(uav).values_list("mission", flat=True).first() if len(missions) > 1 else None
    return next((mission for mission in missions if mission.pk == sent), missions[0] if missions else None)


def speed_limits_mps(uav: Uav) -> tuple[float, float]:
    """Return the lowest and highest speed it can be commanded: its airspeed, or its cruise speed where that is not stated."""
    return MIN_SPEED_MPS, performance_of(uav).max_airspeed_mps or uav.speed_mps


def _parameters(uav: Uav, kind: CommandKind, given: dict[str, Any]) -> dict[str, Any]:
    """Return the parameters of the kind, within their bounds."""
    if kind == CommandKind.CHANGE_SPEED:
        return {"speed_mps": _within("speed_mps", given, *speed_limits_mps(uav), "m/s")}
    if kind == CommandKind.TAKE_OFF:
        return {"altitude_relative_m": _within("altitude_relative_m", given, MIN_TAKE_OFF_M, settings.FLIGHT_RULES.max_agl_m, "m")}
    if kind == CommandKind.SET_RETURN_HEIGHT:
        return _return_height(uav, given)
    if kind == CommandKind.RETURN and given:
        return _of_return(uav, given)
    if kind == CommandKind.START and set(given) == {OUT_OF_SLOT}:
        return dict(given) if given[OUT_OF_SLOT] else {}
    if given:
        raise refuse("no_parameters", _("This command has no parameters."))
    return {}


def _of_return(uav: Uav, given: dict[str, Any]) -> dict[str, Any]:
    """Return a return's parameters: along its route, after a wait, at a height set before, or both. Raises Refused."""
    if set(given) == {ALONG_ROUTE}:
        if given[ALONG_ROUTE] and uav.link == LinkKind.HTTP:
            raise refuse(
                "not_by_companion", _("%(uav)s flies by its companion: it is not sent along its route from here.") % {"uav": uav.name}
            )
        return {ALONG_ROUTE: True} if given[ALONG_ROUTE] else {}
    if not set(given) <= {WAIT_S, HEIGHT_M}:
        raise refuse("no_parameters", _("A return has a wait and a height, or goes along the route."))
    wait_s = _within(WAIT_S, {WAIT_S: given[WAIT_S]}, 0.0, MAX_WAIT_S, "s") if WAIT_S in given else 0.0
    height = _return_height(uav, {HEIGHT_M: given[HEIGHT_M]}) if HEIGHT_M in given else {}
    return height | ({WAIT_S: wait_s} if wait_s > 0.0 else {})


def _return_height(uav: Uav, given: dict[str, Any]) -> dict[str, Any]:
    """Return a return height's parameters. Raises Refused, also if the autopilot's RTL parameters were never read."""
    values = {"uav": uav.name}
    if uav.link == LinkKind.HTTP:
        raise refuse("not_by_companion", _("The return height of %(uav)s is set by its companion, not from here.") % values)
    reported = uav.autopilot_return
    if rtl_behaviour(reported.get("autopilot", ""), reported.get("parameters", {})) is None:
        raise refuse("not_read", _("The return height of %(uav)s was never read: connect it first.") % values)
    heights = {name: value for name, value in given.items() if name != THEN_RETURN}
    checked = {"height_m": _within("height_m", heights, MIN_TAKE_OFF_M, settings.FLIGHT_RULES.max_agl_m, "m")}
    return checked | {THEN_RETURN: True} if given.get(THEN_RETURN) else checked


def _within(name: str, given: dict[str, Any], low: float, high: float, unit: str) -> float:
    value = given.get(name)
    if set(given) != {name} or value is None or not low <= value <= high:
        values = {"name": name, "low": f"{low:g}", "high": f"{high:g}", "unit": unit}
        raise refuse("out_of_range", _("%(name)s is needed, from %(low)s to %(high)s %(unit)s.") % values)
    return float(value)


def _to_move_for(uav: Uav, kind: CommandKind, mission: Mission | None, approval: Approval | None) -> tuple[Mission, Approval]:
    """Return the mission and approval for which the UAV moves: on its way, and started if it resumes. Raises Refused."""
    values = {"uav": uav.name}
    if mission is None or approval is None or mission.state not in ON_ITS_WAY:
        raise refuse("no_mission", _("%(uav)s has no mission.") % values)
    if approval.revoke_requested_at is not None:
        raise refuse("being_revoked", _("The approval is being taken back."))
    if Route.objects.filter(mission=mission, mission_uav__uav=uav, has_failed=True).exists():
        raise refuse("route_failed", _("A flight of %(uav)s has failed: it does not fly on in this mission.") % values)
    if kind in FROM_THE_GROUND and uavs_down_off_plan([uav.pk]):
        words = _("%(uav)s has crashed, or is down away from its plan: close that alert with what became of it before it is started.")
        raise refuse("is_down", words % values)
    if kind in FROM_THE_GROUND:
        refuse_for(incomplete_reasons(mission, [uav.pk]))
    was_started = approval.commands.filter(uav=uav, kind=CommandKind.START, sent_at__isnull=False).exists()
    if kind == CommandKind.RESUME and not (mission.state == MissionState.ACTIVE and was_started):
        raise refuse("not_started", _("%(uav)s has not started its mission: there is nothing to go on with.") % values)
    return mission, approval


def _flight_to_start(
    uav: Uav, mission: Mission, approval: Approval, check: ApprovalCheck | None, now: datetime, *, out_of_slot: bool
) -> int:
    """Return the flight that is onboard, read back, and due. Raises Refused."""
    values = {"uav": uav.name}
    upload = upload_of(approval, uav.pk)
    if upload is None or upload.state != CommandState.APPLIED:
        raise refuse("not_loaded", _("%(uav)s does not have its mission yet.") % values)
    flight = int(upload.parameters.get("flight", 1))
    route = MissionUav.objects.select_related("route__mission_uav", "route__mission").get(mission=mission, uav=uav).route
    if flight <= route.flights_flown:
        raise refuse("flown_already", _("%(uav)s has flown this flight.") % values)
    if flight == 1 and mission.departs_at is not None:
        _refuse_untimely(mission.departs_at + timedelta(seconds=route.departs_s), now, values)
    refuse_for(_reasons_for(route.mission_uav.sequence, valid_check(check, mission, now=now)))
    hold_starts(uav.organisation_id)
    if not out_of_slot:
        refuse_for(reasons_to_wait(uav=uav, route=route, flight=flight, now=now))
    return flight


def _reasons_for(place: int, check: ApprovalCheck) -> list[RefusalReason]:
    """Return current reasons for this UAV: zones may be newer than the upload. Its departure is checked separately."""
    return [reason for reason in check.reasons if reason.uav in (None, place) and reason.code != "departure_past"]


def _refuse_untimely(departs_at: datetime, now: datetime, values: dict[str, str]) -> None:
    """Raise Refused outside the margin of the departure for which zones and other missions were checked."""
    margin = timedelta(seconds=settings.ZONE_RULES.time_margin_s)
    if now < departs_at - margin:
        words = _("%(uav)s departs at %(time)s UTC; it cannot be started yet.")
        raise refuse("too_early", words % {**values, "time": f"{departs_at:%H:%M}"})
    if now > departs_at + margin:
        raise refuse("departure_past", _("The departure of %(uav)s is over. Revoke, and plan it for another time.") % values)
