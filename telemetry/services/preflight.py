"""Preflight checks of a mission's UAVs: what is ready, what prevents a start, and the next act."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from enum import StrEnum
from functools import lru_cache
from typing import Any
from uuid import UUID

import numpy as np
from django.conf import settings
from django.utils import timezone
from django.utils.dateparse import parse_datetime
from django.utils.formats import number_format
from django.utils.translation import get_language
from django.utils.translation import gettext as _

from inspection.geodesy import distance_m
from inspection.selectors import ground_revision
from mavlink.decoding.cameras import CameraDifference, ReportedCamera, camera_differences
from mavlink.rtl import ARDUPILOT, PX4, fence_off_by, fence_on_by
from missions.models import OPEN_COMMANDS, Approval, CommandState, LinkKind, Mission, Route, Uav
from missions.selectors.commands import upload_of
from missions.selectors.fleet import incomplete_uavs, performance_of
from missions.selectors.missions import approval_in_force, mission_of_organisation
from missions.selectors.photo_flights import planned_cameras
from missions.services.approval.checks import check_approval
from missions.services.commands.dispatch import TO_SEND
from missions.services.commands.planned_starts import routes_not_begun, uavs_being_started
from missions.services.commands.refused import RefusalReason
from missions.services.commands.rtl_check import ReturnCheck, ReturnState, return_checks
from missions.services.commands.start_slots import reasons_to_wait
from operation.reasons import Reason
from planning.views.camera import Camera
from telemetry.models import UavLink
from telemetry.selectors.in_the_air import down_off_plan
from telemetry.services.approved_flights import approved_content
from workspace.models import Organisation
from workspace.reason_texts import column_text, reason_text

RECEIVED_WITHIN = timedelta(seconds=15)  # companions report every 10 s
BATTERY_WITHIN = timedelta(seconds=60)
MAP_CHECK_PERIOD_S = 15.0
FIX_IN_SPACE = 3  # GPS_FIX_TYPE of MAVLink: 3D
MORE_WIND_MPS = 3.0  # above the planned wind: warning
AT_ITS_PLACE_M, AWAY_FROM_ITS_PLACE_M = 15.0, 50.0  # from the planned take-off: up to the first OK, above the second no start
HOME_AT_M = 15.0  # from the planned take-off, up to which it is OK; a start reads the home again and refuses one too far away
FENCE_PARAMETERS = {ARDUPILOT: "FENCE_ENABLE", PX4: "GF_ACTION"}  # parameters that enable a fence
Reported = Mapping[str, Mapping[str, Any]]  # groups of the newest reported values; see services/latest.py


class CheckState(StrEnum):
    OK = "ok"
    WARNING = "warning"
    UNKNOWN = "unknown"  # not reported
    WAITING = "waiting"  # resolves by itself, or by the next act
    FAILED = "failed"  # prevents the start


class NextAct(StrEnum):
    CONNECT = "connect"
    UPLOAD = "upload"
    WAIT = "wait"  # uploads are under way
    START = "start"


@dataclass(frozen=True)
class Check:
    """One check. `code` is short and stable; `message` is a sentence, or a short phrase if OK.

    safe_height_m: for an obstructed return, the clear height above take-off. detail: unread autopilot parameters, for set-up; empty: none.
    """

    code: str
    state: CheckState
    message: str
    safe_height_m: float | None = None
    detail: str = ""


@dataclass(frozen=True)
class UavPreflight:
    uav: int
    name: str
    place: int
    is_loaded: bool
    checks: tuple[Check, ...]

    @property
    def blocks(self) -> bool:
        return any(check.state == CheckState.FAILED for check in self.checks)

    @property
    def is_ready(self) -> bool:
        """Return whether it can start without waiting for other UAVs of its mission."""
        return self.is_loaded and not self.blocks


@dataclass(frozen=True)
class Preflight:
    """Preflight of a mission. `next_act` is None if nothing is left to start. `checks` apply to the whole mission."""

    next_act: NextAct | None
    checks: tuple[Check, ...]
    uavs: tuple[UavPreflight, ...]


def preflight_of(mission: Mission, *, now: datetime) -> Preflight:
    """Return the checks of UAVs whose first flight has not begun and which are not being started. Raises NoGraph."""
    approval = approval_in_force(mission)
    if approval is None or approval.revoke_requested_at is not None or mission.state not in TO_SEND:
        return Preflight(None, (), ())
    related = ("mission", "mission_uav__uav__uav_type", "mission_uav__uav__connection", "mission_uav__uav__watch")
    starting = uavs_being_started(mission)
    routes = list(routes_not_begun(mission, approval).exclude(mission_uav__uav__in=starting).select_related(*related))
    if not routes:
        return Preflight(None, (), ())
    period = int(now.timestamp() // MAP_CHECK_PERIOD_S)
    read_at = tuple(None if route.mission_uav.uav is None else route.mission_uav.uav.autopilot_return_read_at for route in routes)
    found = _checked_on_the_map(mission.organisation_id, mission.pk, mission.revision, ground_revision(), read_at, get_language(), period)
    down = down_off_plan([route.mission_uav.uav_id for route in routes if route.mission_uav.uav_id is not None])
    cameras = planned_cameras(routes)
    rows = tuple(
        _uav_preflight(uav, route, approval, found, down, cameras.get(route.pk, []), now)
        for route in routes
        if (uav := route.mission_uav.uav) is not None
    )
    own = tuple(_against(found.reasons, None))
    clear = Check("ground", CheckState.OK, _("No zone in force and nothing on the ground is in the way"))
    return Preflight(_next_act(rows), own if found.reasons else (clear,), rows)


@dataclass(frozen=True)
class _OnTheMap:
    """Result of checking routes and RTL paths against zones, terrain and obstacles, by place in the mission."""

    reasons: tuple[RefusalReason, ...]
    returns: Mapping[int | None, ReturnCheck]


@lru_cache(maxsize=64)
def _checked_on_the_map(
    organisation_id: int, mission_id: UUID, revision: int, ground: int, read_at: tuple[datetime | None, ...], language: str, period: int
) -> _OnTheMap:
    """Check routes and RTL paths, the costliest part of a preflight, at most once per period.

    The arguments change with every input but time and other missions. A start runs its own check.
    """
    mission = mission_of_organisation(Organisation(pk=organisation_id), mission_id)
    check = check_approval(mission, now=timezone.now())
    return _OnTheMap(() if check is None else check.reasons, {check.place: check for check in return_checks(mission)})


def _next_act(rows: tuple[UavPreflight, ...]) -> NextAct:
    """Return the next act. Connected UAVs without the mission come first; silent UAVs and failed uploads do not delay other starts."""
    states = [{check.code: check.state for check in row.checks} for row in rows if not row.is_loaded]
    links = [found["mission"] for found in states if found["link"] == CheckState.OK]
    if CheckState.WAITING in links:
        return NextAct.WAIT
    if CheckState.UNKNOWN in links:
        return NextAct.UPLOAD
    if not states or any(row.is_ready for row in rows):
        return NextAct.START
    return NextAct.UPLOAD if links else NextAct.CONNECT


def reasons_not_ready(mission: Mission, uav_ids: Collection[int]) -> list[RefusalReason]:
    """Return the failed preflight checks of these UAVs and their mission; none for a mission that cannot be started."""
    found = preflight_of(mission, now=timezone.now())
    against = [RefusalReason(check.code, check.message) for check in found.checks if check.state == CheckState.FAILED]
    for row in found.uavs:
        if row.uav in uav_ids:
            against += [
                RefusalReason(check.code, f"{row.name}: {check.message}", row.place)
                for check in row.checks
                if check.state == CheckState.FAILED
            ]
    return against


def _against(reasons: Sequence[RefusalReason], place: int | None) -> Iterator[Check]:
    """Return the reasons against this UAV's route, or against the whole mission."""
    return (Check(reason.code, CheckState.FAILED, reason.message) for reason in reasons if reason.uav == place)


def _uav_preflight(
    uav: Uav, route: Route, approval: Approval, found: _OnTheMap, down: Collection[int], cameras: Sequence[Camera], now: datetime
) -> UavPreflight:
    place = route.mission_uav
    link, watch = getattr(uav, "connection", None) or UavLink(uav=uav), getattr(uav, "watch", None)
    reported: Reported = (watch.measured if watch is not None else None) or {}
    onboard = _onboard_mission(uav, approval, link)
    is_loaded = onboard.state in (CheckState.OK, CheckState.WARNING)
    checks = (
        *_crash(uav, down), *_incomplete(uav, place.name), _link(link, reported, now), _position(route, reported), _home(uav, route, link),
        _battery(uav, route, reported, now), onboard, *_fence(uav, place.name, approval, link),
        *_returns(found.returns.get(place.sequence)), *_cameras(uav, link, cameras), _wind(route.mission, reported),
        *(_others(uav, route, now) if is_loaded else ()), *_against(found.reasons, place.sequence),
    )  # fmt: skip
    return UavPreflight(uav.pk, place.name, place.sequence, is_loaded, checks)


def _crash(uav: Uav, down: Collection[int]) -> Iterator[Check]:
    if uav.pk in down:
        words = _("It has crashed, or is down away from its plan. Close that alert with what became of it.")
        yield Check("crash", CheckState.FAILED, words)


def _incomplete(uav: Uav, name: str) -> Iterator[Check]:
    for code in incomplete_uavs([uav]).values():
        yield Check("incomplete", CheckState.FAILED, reason_text(Reason(f"uav_{code}", {"uav": name})))


def _link(link: UavLink, reported: Reported, now: datetime) -> Check:
    received = parse_datetime(reported["report"]["received_at"]) if "report" in reported else None
    links = max((moment for moment in (link.last_message_at, received) if moment is not None), default=None)
    if links is None:
        words = _("Never connected. Switch it on, and check its connection.")
        if link.uav.is_simulated:
            words = _("Not connected. It connects by itself once its simulation runs.")
        return Check("link", CheckState.FAILED, words)
    age_s = max((now - links).total_seconds(), 0.0)
    if age_s > RECEIVED_WITHIN.total_seconds():
        words = _("Last heard %(age)s ago. Switch it on, and check its connection.")
        if link.uav.is_simulated:
            words = _("Last heard %(age)s ago. It connects by itself once its simulation runs.")
        return Check("link", CheckState.FAILED, words % {"age": _duration(age_s)})
    return Check("link", CheckState.OK, _("Connected"))


def _position(route: Route, reported: Reported) -> Check:
    fix, place = reported.get("gps", {}).get("gps_fix"), reported.get("position", {}).get("position")
    if fix is not None and fix < FIX_IN_SPACE:
        return Check("position", CheckState.FAILED, _("It has no position yet. Wait for its satellite receiver."))
    if place is None:
        return Check("position", CheckState.UNKNOWN, _("It has told no position."))
    away_m = _away_m(place, route)
    if away_m > AWAY_FROM_ITS_PLACE_M:
        words = _("It stands %(metres)s m from its planned take-off place. Carry it there, or plan its start anew.")
        return Check("position", CheckState.FAILED, words % {"metres": f"{away_m:.0f}"})
    state = CheckState.OK if away_m <= AT_ITS_PLACE_M else CheckState.WARNING
    return Check("position", state, _("%(metres)s m from its planned take-off place") % {"metres": f"{away_m:.0f}"})


def _home(uav: Uav, route: Route, link: UavLink) -> Check:
    """Check the last reported home position, the destination of RTL and origin of heights. Arming sets it again."""
    if link.home is None:
        words = _("Its companion reports no home position.") if uav.link == LinkKind.HTTP else _("It has not reported its home position.")
        return Check("home", CheckState.UNKNOWN, words)
    away_m = _away_m(link.home.coords[:2], route)
    values = {"metres": f"{away_m:.0f}"}
    if away_m > HOME_AT_M:
        words = _("Its home position, as last reported, is %(metres)s m from its planned take-off place: Return leads there.")
        return Check("home", CheckState.WARNING, words % values)
    return Check("home", CheckState.OK, _("Home position %(metres)s m from its planned take-off place") % values)


def _away_m(place: Sequence[float], route: Route) -> float:
    """Return the distance from the planned take-off. place: longitude, latitude [deg]."""
    return float(distance_m(np.array([place]), np.array([route.mission_uav.start.coords]))[0])


def _battery(uav: Uav, route: Route, reported: Reported, now: datetime) -> Check:
    battery = reported.get("battery", {})
    percent = battery.get("battery_percent")
    measured = parse_datetime(battery["measured_at"]) if battery else None
    if percent is None or measured is None or now - measured > BATTERY_WITHIN:
        return Check("battery", CheckState.UNKNOWN, _("It does not report its battery."))
    if route.battery_percent is None:
        return Check("battery", CheckState.UNKNOWN, _("%(percent)s %%; what its flight takes is not known") % {"percent": f"{percent:.0f}"})
    lands_with, reserve = percent - (100.0 - route.battery_percent), performance_of(uav).reserve_percent
    values = {"percent": f"{percent:.0f}", "lands": f"{max(lands_with, 0.0):.0f}", "reserve": f"{reserve:.0f}"}
    if lands_with < reserve - 0.5:
        words = _("%(percent)s %%: it would land with %(lands)s %%, below the reserve of %(reserve)s %%. Charge or change it.")
        return Check("battery", CheckState.FAILED, words % values)
    return Check("battery", CheckState.OK, _("%(percent)s %%, lands with %(lands)s %% (reserve %(reserve)s %%)") % values)


def _onboard_mission(uav: Uav, approval: Approval, link: UavLink) -> Check:
    upload = upload_of(approval, uav.pk)
    if upload is None:
        return Check("mission", CheckState.UNKNOWN, _("Not uploaded"))
    if upload.state in OPEN_COMMANDS:
        return Check("mission", CheckState.WAITING, _("Being uploaded"))
    if upload.state != CommandState.APPLIED:
        return Check(
            "mission",
            CheckState.FAILED,
            _("Not uploaded: %(why)s") % {"why": column_text(upload.outcome_why, upload.outcome) or upload.get_state_display()},
        )
    if link.loaded_doubt:
        return Check("mission", CheckState.WARNING, _("Uploaded; it may hold something else by now, and is read back before it starts"))
    return Check("mission", CheckState.OK, _("Uploaded and read back: as approved"))


def _fence(uav: Uav, name: str, approval: Approval, link: UavLink) -> Iterator[Check]:
    """Check by its parameters whether the autopilot obeys the route's approved fence; no check without a fence."""
    approved = approved_content(approval.pk, uav.pk, 1)
    if approved is None or not approved.has_fence:
        return
    reported = uav.autopilot_return
    autopilot, parameters = reported.get("autopilot", ""), reported.get("parameters", {})
    if off_by := fence_off_by(autopilot, parameters):
        words = _("%(uav)s ignores the fence that goes with the mission: its autopilot has %(parameter)s.")
        yield Check("fence", CheckState.WARNING, words % {"uav": name, "parameter": off_by})
    elif on_by := fence_on_by(autopilot, parameters):
        yield Check("fence", CheckState.OK, _("Fence active: %(parameter)s") % {"parameter": on_by})
    else:
        parameter = FENCE_PARAMETERS.get(autopilot or link.autopilot, " / ".join(FENCE_PARAMETERS.values()))
        yield Check("fence", CheckState.UNKNOWN, _("Whether the fence is active: not reported by the autopilot."), detail=parameter)


def _returns(check: ReturnCheck | None) -> Iterator[Check]:
    if check is None:
        return
    states = {ReturnState.CLEAR: CheckState.OK, ReturnState.IN_THE_WAY: CheckState.WARNING}
    words = " ".join(check.warnings)
    if check.state == ReturnState.CLEAR and check.height_m is not None:
        words = _("Return at %(metres)s m is clear") % {"metres": f"{check.height_m:.0f}"}
    if words:
        yield Check("return", states.get(check.state, CheckState.UNKNOWN), words, check.safe_height_m, check.detail)


def _cameras(uav: Uav, link: UavLink, planned: Sequence[Camera]) -> Iterator[Check]:
    """Compare what its cameras report with each camera of its photos; no check without photos."""
    reported = [one for value in link.cameras if (one := ReportedCamera.from_json(value)).has_sensor] if planned else []
    for camera in planned:
        values = {"camera": camera.name}
        if reported and (found := min((camera_differences(one, camera) for one in reported), key=len)):
            words = _("Its camera is not the planned one, %(camera)s: %(differences)s. Photos may not show what was planned.")
            yield Check("camera", CheckState.WARNING, words % (values | {"differences": ", ".join(map(_difference, found))}))
        elif reported:
            yield Check("camera", CheckState.OK, _("Camera as planned: %(camera)s") % values)
        elif uav.link == LinkKind.MAVLINK:
            yield Check("camera", CheckState.UNKNOWN, _("It does not report its camera; planned: %(camera)s.") % values)


def _difference(one: CameraDifference) -> str:
    words = {
        "focal_length": _("focal length %(reported)s mm instead of %(planned)s mm"),
        "sensor": _("sensor %(reported)s mm instead of %(planned)s mm"),
        "pixels": _("%(reported)s pixels instead of %(planned)s"),
    }[one.figure]
    reported, planned = (" × ".join(number_format(round(value, 1)) for value in values) for values in (one.reported, one.planned))
    return words % {"reported": reported, "planned": planned}


def _wind(mission: Mission, reported: Reported) -> Check:
    """Check the wind, which most vehicles only report in the air."""
    measured_mps = reported.get("wind", {}).get("wind_speed_mps")
    layers = (mission.conditions or {}).get("wind") or []
    planned_mps = max((float(layer["speed_mps"]) for layer in layers), default=0.0)
    if measured_mps is None:
        return Check("wind", CheckState.UNKNOWN, _("Wind not reported, %(planned)s m/s planned") % {"planned": f"{planned_mps:.0f}"})
    values = {"measured": f"{measured_mps:.0f}", "planned": f"{planned_mps:.0f}"}
    state = CheckState.WARNING if measured_mps > planned_mps + MORE_WIND_MPS else CheckState.OK
    return Check("wind", state, _("Wind %(measured)s m/s measured, %(planned)s m/s planned") % values)


def _others(uav: Uav, route: Route, now: datetime) -> Iterator[Check]:
    for reason in reasons_to_wait(uav=uav, route=route, flight=1, now=now):
        yield Check("others", CheckState.WAITING, reason.message)
    if route.mission.departs_at is not None:
        departs_at = route.mission.departs_at + timedelta(seconds=route.departs_s)
        if now < departs_at - timedelta(seconds=settings.ZONE_RULES.time_margin_s):
            yield Check("departure", CheckState.WAITING, _("Departs at %(time)s UTC") % {"time": f"{departs_at:%H:%M}"})


def _duration(seconds: float) -> str:
    if seconds < 120.0:
        return _("%(seconds)s s") % {"seconds": f"{seconds:.0f}"}
    if seconds < 7_200.0:
        return _("%(minutes)s min") % {"minutes": f"{seconds / 60.0:.0f}"}
    return _("%(hours)s h") % {"hours": f"{seconds / 3_600.0:.0f}"}
