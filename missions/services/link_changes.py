"""By which door, and under which number, a UAV is reached: this stays as it is while anything is on its way to it."""

from collections.abc import Mapping
from typing import Any

from django.utils.translation import gettext as _

from missions.flight_hooks import is_in_flight
from missions.models import OPEN_COMMANDS, MissionState, MissionUav, Uav, UavState
from missions.services.refused import Reason, refuse_for

REACHED_BY = ("link", "mavlink_system_id", "allows_unsigned")
ON_ITS_WAY = (MissionState.DISPATCHED, MissionState.ACTIVE)


def refuse_to_cut_off(uav: Uav, before: Mapping[str, Any]) -> None:
    """Raises Refused for a change after which a command that waits, be it an abort, would reach nobody or somebody else.

    Nor is a UAV that flies taken for a simulated one: somebody else would answer in its place. That it is real can be said at any time.

    The caller holds the UAV's row, so that no command is given meanwhile. before: its facts.
    """
    changed = [name for name in REACHED_BY if getattr(uav, name) != before[name]]
    if uav.is_simulated and not before["is_simulated"]:
        changed.append("is_simulated")
    is_retired = uav.state == UavState.RETIRED != before["state"]  # it is let in no more, and has no system id
    if is_retired:
        changed.append("state")
    if not changed or (changed == ["mavlink_system_id"] and before["mavlink_system_id"] is None):  # one without an id reached nobody
        return
    refuse_for(_reasons(uav, is_flight_one=is_retired and not before["is_simulated"])[:1])


def refuse_while_needed(uav: Uav) -> None:
    """Raises Refused for a key or token that is replaced or revoked while the UAV flies, or anything is on its way to it."""
    refuse_for(_reasons(uav, is_flight_one=True))


def _reasons(uav: Uav, *, is_flight_one: bool) -> list[Reason]:
    values, reasons = {"uav": uav.name}, []
    if uav.commands.filter(state__in=OPEN_COMMANDS).exists():
        reasons.append(
            Reason("commands_waiting", _("A command to %(uav)s is not done yet: how it is reached cannot be changed now.") % values)
        )
    flown = MissionUav.objects.filter(uav=uav, mission__state__in=ON_ITS_WAY, mission__deleted_at=None, route__geometry__isnull=False)
    flown = flown.filter(route__continued_by=None)
    if flown.exists():
        reasons.append(
            Reason("mission_on_its_way", _("%(uav)s has a mission on its way: how it is reached cannot be changed now.") % values)
        )
    if is_flight_one and is_in_flight(uav):
        reasons.append(Reason("in_flight", _("%(uav)s flies: a new key or token could cut it off. Wait until it has landed.") % values))
    return reasons
