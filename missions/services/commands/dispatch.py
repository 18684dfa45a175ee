"""Send an approved mission to its UAVs, one flight at a time, and abort one that is on its way."""

from dataclasses import dataclass
from typing import Any
from uuid import UUID

from django.db import transaction
from django.db.models import Q, QuerySet
from django.utils import timezone
from django.utils.translation import gettext as _

from inspection.geodesy import LonLat
from mavlink.approved_route import FrozenRoute, TakeOff, route_from_json
from mavlink.vehicle_plan import FlightLoad, load_from_json
from missions.models import (
    OPEN_COMMANDS,
    Approval,
    CommandKind,
    CommandState,
    LinkKind,
    Mission,
    MissionState,
    MissionUav,
    Uav,
    UavCommand,
)
from missions.selectors.commands import upload_of
from missions.selectors.missions import approval_in_force
from missions.services.approval.approval import change_state, locked_mission, uavs_that_may_hold
from missions.services.approval.checks import check_approval, incomplete_reasons, valid_check
from missions.services.approval.document import content_sha256
from missions.services.commands.flight_progress import ON_ITS_WAY
from missions.services.commands.outbox import queue_command
from missions.services.commands.refused import RefusalReason, refuse, refuse_for
from workspace.models import User

TO_SEND = (MissionState.APPROVED, MissionState.DISPATCHED, MissionState.ACTIVE)

UNSUCCESSFUL = (MissionState.FAILED, MissionState.ABORTED)


class DamagedApproval(Exception):
    """Raised when a document's hash differs from the approved one."""


@dataclass(frozen=True)
class ApprovedLoad:
    """The approved content of one flight of a UAV.

    `load` is None for a UAV with a companion computer, which flies from `content`: the flight in plain values. `flight` counts from 1 to
    `flights`; `waypoints` are the places in the route that belong to it. `content_sha256` names exactly this load.
    """

    approval: UUID
    mission: UUID
    uav: int
    flight: int
    flights: int
    take_off: TakeOff
    waypoints: tuple[int, ...]
    route: FrozenRoute
    load: FlightLoad | None
    content: dict[str, Any] | None
    content_sha256: str


def dispatch_mission(
    *, mission: Mission, actor: User, expected_revision: int | None = None, place: int | None = None, flight: int = 1, why: str = ""
) -> list[UavCommand]:
    """Queue the approved routes whose first flight is neither onboard nor on its way, or one flight of one UAV.

    `place` is the UAV's in the mission. Raises MissionChanged or Refused.
    """
    check = check_approval(mission, now=timezone.now())
    with transaction.atomic():
        held = locked_mission(mission.pk, expected_revision)
        approval = approval_in_force(held)
        if approval is None or held.state not in TO_SEND:
            raise refuse("not_approved", _("Only an approved mission can be uploaded to UAVs."))
        if approval.revoke_requested_at is not None:
            raise refuse("being_revoked", _("The approval is being taken back."))
        document = _sound_document(approval)
        wanted = [route for route in document["routes"] if place is None or route["place"] == place]
        if not wanted:
            raise refuse("no_route", _("This UAV flies no route."), place)
        if not any(0 < flight <= len(route["flights"]) for route in wanted):
            raise refuse("no_flight", _("This UAV has no such flight."), place)
        against = valid_check(check, held, now=timezone.now()).reasons
        to_send = [route for route in wanted if place is not None or not _is_on_its_way(approval, route["uav"])]
        incomplete = incomplete_reasons(held, [route["uav"] for route in to_send])
        refuse_for([*_uav_reasons(held, wanted), *_link_reasons(wanted), *incomplete, *against])
        refuse_for([] if to_send else [RefusalReason("nothing_to_send", _("Every UAV has its route already, or it is on its way."))])
        if place is not None:
            refuse_for(_flight_reasons(held, approval, to_send[0], flight))
        commands = [
            queue_command(
                uav=Uav.objects.get(pk=route["uav"]), kind=CommandKind.UPLOAD_MISSION, actor=actor, why=why, mission=held,
                approval=approval, parameters={"flight": flight},
            )
            for route in sorted(to_send, key=lambda route: int(route["uav"]))
        ]  # fmt: skip
        state = MissionState.DISPATCHED if held.state == MissionState.APPROVED else MissionState(held.state)
        sent = [{"uav": command.uav_id, "flight": flight, "command": str(command.pk)} for command in commands]
        change_state(held, state, actor, "dispatch", {"approval": str(approval.pk), "sent": sent, "why": why})
    return commands


def abort_mission(*, mission: Mission, actor: User, why: str, expected_revision: int | None = None) -> list[UavCommand]:
    """End a mission that is on its way: every UAV that may hold it gets an abort, before anything else. Raises MissionChanged or Refused.

    A mission that was not started is also cleared from the UAVs. An ended one is aborted again while a UAV that flies nothing else may hold
    it: reports on its flights or on the delivery of an earlier abort may be wrong.
    """
    with transaction.atomic():
        held = locked_mission(mission.pk, expected_revision)
        approval = approval_in_force(held)
        is_over = held.state in UNSUCCESSFUL
        if approval is None or not (is_over or held.state in ON_ITS_WAY):
            raise refuse("not_on_its_way", _("Only an uploaded mission can be aborted."))
        continued = set(held.routes.filter(continued_by__isnull=False).values_list("mission_uav__uav", flat=True))
        in_use = {route["uav"] for route in approval.document["routes"]} - continued
        touched = Uav.objects.filter(Q(pk__in=uavs_that_may_hold(approval)) | Q(pk__in=in_use, commands__mission=held))
        if is_over:
            touched = Uav.objects.filter(pk__in=uavs_that_may_hold(approval)).exclude(pk__in=busy_elsewhere(held))
        uavs = list(touched.distinct().order_by("pk"))
        if is_over and not uavs:
            raise refuse("not_on_its_way", _("No UAV holds this mission any more."))
        commands = []
        for uav in uavs:
            common: dict[str, Any] = {"uav": uav, "actor": actor, "why": why, "mission": held, "approval": approval}
            commands.append(queue_command(kind=CommandKind.ABORT, **common))
            if held.state == MissionState.DISPATCHED:
                commands.append(queue_command(kind=CommandKind.CLEAR_MISSION, **common))
        state = MissionState(held.state) if is_over else MissionState.ABORTED
        change_state(held, state, actor, "abort", {"approval": str(approval.pk), "why": why})
    return commands


def busy_elsewhere(mission: Mission) -> QuerySet[MissionUav, Any]:
    """Return UAVs that fly a route of another mission."""
    others = MissionUav.objects.filter(mission__state__in=ON_ITS_WAY, mission__deleted_at=None, route__geometry__isnull=False)
    others = others.filter(route__continued_by=None)
    return others.exclude(mission=mission).filter(uav__isnull=False).values("uav")


def load_of(command: UavCommand) -> ApprovedLoad:
    """Return what an upload puts on the UAV, or what a start expects there, read only from the approval's document.

    Raises DamagedApproval.
    """
    approval = command.approval
    if approval is None:
        raise ValueError(f"{command.kind} of {command.pk} belongs to no approval")
    return approved_load(approval, uav_id=command.uav_id, flight=int(command.parameters.get("flight", 1)))


def approved_load(approval: Approval, *, uav_id: int, flight: int) -> ApprovedLoad:
    """Return the load of a UAV's flight. Raises DamagedApproval, or LookupError for a UAV or flight that the approval does not have."""
    route = next(route for route in _sound_document(approval)["routes"] if route["uav"] == uav_id)
    flights = route["flights"]
    own = flights[flight - 1]
    return ApprovedLoad(
        approval=approval.pk,
        mission=approval.mission_id,
        uav=uav_id,
        flight=flight,
        flights=len(flights),
        take_off=TakeOff(LonLat(*own["take_off"]["position"]), own["take_off"]["altitude_amsl_m"]),
        waypoints=tuple(own["waypoints"]),
        route=route_from_json(route["route"]),
        load=None if own["items"] is None else load_from_json(own["items"]),
        content=own["content"],
        content_sha256=own["content_sha256"],
    )


def _sound_document(approval: Approval) -> dict[str, Any]:
    document: dict[str, Any] = approval.document
    if content_sha256(document) != approval.content_sha256:
        raise DamagedApproval(str(approval.pk))
    return document


def _uav_reasons(mission: Mission, routes: list[dict[str, Any]]) -> list[RefusalReason]:
    """Return reasons for routes whose UAV is not in the fleet, appears twice, or is busy."""
    reasons = []
    named = [route["uav"] for route in routes]
    for route in routes:
        values = {"uav": route["name"]}
        if route["uav"] is not None and named.count(route["uav"]) > 1:
            reasons.append(RefusalReason("uav_twice", _("%(uav)s has two routes in this mission.") % values, route["place"]))
        if route["uav"] is None:
            reasons.append(
                RefusalReason("not_in_fleet", _("%(uav)s is not a UAV of the fleet: it cannot be sent anything.") % values, route["place"])
            )
            continue
        others = MissionUav.objects.filter(
            uav=route["uav"], mission__state__in=ON_ITS_WAY, mission__deleted_at=None, route__geometry__isnull=False,
            route__continued_by=None,
        )  # fmt: skip
        other = others.exclude(mission=mission).select_related("mission").first()
        if other is not None:
            words = _("%(uav)s is busy with %(mission)s.") % {**values, "mission": other.mission.name}
            reasons.append(RefusalReason("uav_busy", words, route["place"]))
    return reasons


def _link_reasons(routes: list[dict[str, Any]]) -> list[RefusalReason]:
    """Return reasons for UAVs whose link kind changed: items are for autopilots, routes for companions, so they need a new approval."""
    links = dict(Uav.objects.filter(pk__in=[route["uav"] for route in routes]).values_list("pk", "link"))
    words = _("%(uav)s is connected otherwise than when it was approved. Revoke, and approve it again.")
    return [
        RefusalReason("link_changed", words % {"uav": route["name"]}, route["place"])
        for route in routes
        if route["uav"] is not None
        and (route["flights"][0]["items"] is None) == (links.get(route["uav"], LinkKind.MAVLINK) == LinkKind.MAVLINK)
    ]


def _is_on_its_way(approval: Approval, uav_id: int) -> bool:
    """Whether the UAV's latest mission command is an upload of this approval that is open or applied."""
    upload = upload_of(approval, uav_id)
    return upload is not None and (upload.state in OPEN_COMMANDS or upload.state == CommandState.APPLIED)


def _flight_reasons(mission: Mission, approval: Approval, route: dict[str, Any], flight: int) -> list[RefusalReason]:
    """Return reasons by flight order; nothing is sent to a UAV in flight, as even a refused upload changes its route."""
    flown, has_failed = mission.routes.filter(mission_uav__sequence=route["place"]).values_list("flights_flown", "has_failed").get()
    started = approval.commands.filter(uav=route["uav"], kind=CommandKind.START, state=CommandState.APPLIED)
    values, place = {"uav": route["name"]}, route["place"]
    if has_failed:
        return [RefusalReason("route_failed", _("A flight of %(uav)s has failed: it does not fly on in this mission.") % values, place)]
    if flight <= flown:
        return [RefusalReason("flown_already", _("%(uav)s has flown this flight.") % values, place)]
    if started.filter(parameters__flight=flown + 1).exists():
        return [RefusalReason("being_flown", _("%(uav)s is flying. Wait until it is down.") % values, place)]
    if flight > flown + 1:
        return [RefusalReason("flight_before", _("%(uav)s has not flown the flight before this one.") % values, place)]
    return []
