"""What the watch sees of UAVs becomes alerts: opened, raised and closed in bulk."""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime

from telemetry.alerting.book import Closed, Opened, changes
from telemetry.alerting.limits import InvalidLimits, Limits, limits_of
from telemetry.alerting.memory import Memory
from telemetry.alerting.order import CODES, DETECTORS
from telemetry.alerting.situation import Situation
from telemetry.alerting.surroundings import LinkFacts
from telemetry.alerting.watched import WatchedUav
from telemetry.models import UavLink
from telemetry.selectors.alerts import open_alerts_of, stated_limits
from telemetry.services.alert_rows import close_alerts_of_ended_missions, settle


@dataclass
class Memories:
    """What one process remembers from look to look, by UAV. It may be lost: the alerts themselves are rows."""

    of_uav: dict[int, Memory] = field(default_factory=lambda: defaultdict(Memory))

    def keep_only(self, uav_ids: Iterable[int]) -> None:
        for uav_id in self.of_uav.keys() - set(uav_ids):
            del self.of_uav[uav_id]


_OF_THIS_PROCESS = Memories()


def look(*, watched: Sequence[WatchedUav], now: datetime, memories: Memories | None = None) -> None:
    """Opens, raises and closes alerts of UAVs that this process watches. Called once a second; safe to call again."""
    memories = _OF_THIS_PROCESS if memories is None else memories
    memories.keep_only(uav.uav_id for uav in watched)
    close_alerts_of_ended_missions(codes=CODES, now=now)
    if not watched:
        return
    uav_ids = [uav.uav_id for uav in watched]
    links, open_rows = _links(uav_ids), open_alerts_of(uav_ids, CODES)
    limits = _limits(watched)
    found: list[tuple[WatchedUav, Opened | Closed]] = []
    for uav in watched:
        memory = memories.of_uav[uav.uav_id]
        memory.take(uav.newest)
        situation = Situation(
            now_s=now.timestamp(),
            uav=uav,
            limits=limits[uav.uav_id],
            memory=memory,
            link=links.get(uav.uav_id, LinkFacts()),
            open_levels={(row.code, row.subject): row.level for row in open_rows[uav.uav_id]},
        )
        found += [(uav, change) for change in changes(situation, DETECTORS)]
    settle(found, open_rows=open_rows, now=now)


def _links(uav_ids: Sequence[int]) -> dict[int, LinkFacts]:
    rows = UavLink.objects.filter(uav__in=uav_ids).values_list("uav_id", "heard_at", "mode", "is_armed", "is_in_air")
    return {
        uav_id: LinkFacts(None if heard_at is None else heard_at.timestamp(), mode, is_armed, is_in_air)
        for uav_id, heard_at, mode, is_armed, is_in_air in rows
    }


def _limits(watched: Sequence[WatchedUav]) -> dict[int, Limits]:
    stated = stated_limits({(uav.uav_id, uav.mission_id) for uav in watched})
    return {uav.uav_id: _sound(stated.get((uav.uav_id, uav.mission_id), ())) for uav in watched}


def _sound(stated: Sequence[Mapping[str, float]]) -> Limits:
    """Limits that were stored past their check do not blind the watch."""
    try:
        return limits_of(*stated)
    except InvalidLimits:
        return Limits()
