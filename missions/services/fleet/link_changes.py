"""Guards of a UAV's link and system id, which may not change while a flight or command depends on them."""

from collections.abc import Iterator, Mapping
from typing import Any

from django.utils.translation import gettext as _

from missions.hooks.flights import is_in_flight
from missions.models import OPEN_COMMANDS, MissionState, MissionUav, Uav, UavState
from missions.services.commands.refused import RefusalReason, refuse_for

REACHED_BY = ("link", "mavlink_system_id", "allows_unsigned")
COMMANDS_WAITING, MISSION_ON_ITS_WAY, IN_FLIGHT = "commands_waiting", "mission_on_its_way", "in_flight"
ON_ITS_WAY = (MissionState.DISPATCHED, MissionState.ACTIVE)


def refuse_to_cut_off(uav: Uav, before: Mapping[str, Any]) -> None:
    """Raise Refused for a change after which a waiting command, such as an abort, would reach no UAV or another one.

    Nor may a flying UAV become simulated: another vehicle would answer in its place. It can become a real one at any time.

    The caller holds the UAV's row, so that no command is given meanwhile. before: its facts.
    """
    changed = [name for name in REACHED_BY if getattr(uav, name) != before[name]]
    if uav.is_simulated and not before["is_simulated"]:
        changed.append("is_simulated")
    is_retired = uav.state == UavState.RETIRED != before["state"]  # it may no longer connect, and has no system id
    if is_retired:
        changed.append("state")
    if not changed or (changed == ["mavlink_system_id"] and before["mavlink_system_id"] is None):  # without an id it had no link
        return
    if is_retired:
        refuse_for(_removal_reasons(uav, is_flight_one=not before["is_simulated"])[:1])
    refuse_for(_reasons(uav, is_flight_one=False)[:1])


def removal_reasons(uav: Uav) -> list[RefusalReason]:
    """Return why this UAV cannot be deleted now; empty where it can."""
    return _removal_reasons(uav, is_flight_one=not uav.is_simulated)[:1]


def refuse_while_needed(uav: Uav) -> None:
    """Raise Refused for a key or token that is replaced or revoked while the UAV flies, or a command is on its way to it."""
    refuse_for(_reasons(uav, is_flight_one=True))


def _reasons(uav: Uav, *, is_flight_one: bool) -> list[RefusalReason]:
    words = {
        COMMANDS_WAITING: _("A command to %(uav)s is not done yet: how it is reached cannot be changed now."),
        MISSION_ON_ITS_WAY: _("%(uav)s has a mission on its way: how it is reached cannot be changed now."),
        IN_FLIGHT: _("%(uav)s flies: a new key or token could cut it off. Wait until it has landed."),
    }
    return [RefusalReason(code, words[code] % {"uav": uav.name}) for code in _needs(uav, is_flight_one=is_flight_one)]


def _removal_reasons(uav: Uav, *, is_flight_one: bool) -> list[RefusalReason]:
    words = {
        COMMANDS_WAITING: _("A command to %(uav)s is not done yet. It can be retired or deleted once it is."),
        MISSION_ON_ITS_WAY: _("%(uav)s has a mission on its way. It can be retired or deleted once that has ended."),
        IN_FLIGHT: _("%(uav)s is in the air. It can be retired or deleted once it has landed."),
    }
    return [RefusalReason(code, words[code] % {"uav": uav.name}) for code in _needs(uav, is_flight_one=is_flight_one)]


def _needs(uav: Uav, *, is_flight_one: bool) -> Iterator[str]:
    """Yield the reasons for which the UAV must stay reachable."""
    if uav.commands.filter(state__in=OPEN_COMMANDS).exists():
        yield COMMANDS_WAITING
    flown = MissionUav.objects.filter(uav=uav, mission__state__in=ON_ITS_WAY, mission__deleted_at=None, route__geometry__isnull=False)
    if flown.filter(route__continued_by=None).exists():
        yield MISSION_ON_ITS_WAY
    if is_flight_one and is_in_flight(uav):
        yield IN_FLIGHT
