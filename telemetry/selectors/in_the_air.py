"""Which UAVs are in the air, on the ground, down off their plans, or were never heard, by their last word."""

from collections.abc import Collection
from datetime import timedelta

from django.db.models import Exists, OuterRef
from django.db.models.functions import Now

from inspection.geodesy import LonLat
from missions.command_rules import SETS_IN_MOTION
from missions.models import UavCommand
from telemetry.alerting.detectors import down
from telemetry.models import Alert, UavLink, UavWatch

BELIEVED_FOR = timedelta(minutes=10)  # after its last word: longer flights without a word are rare


def reported_in_the_air(uav_ids: Collection[int]) -> set[int]:
    """Of these UAVs, by link or by their newest report."""
    by_link = UavLink.objects.filter(uav__in=uav_ids, is_in_air=True, last_message_at__gt=Now() - BELIEVED_FOR)
    by_report = UavWatch.objects.filter(uav__in=uav_ids, measured__state__is_in_air=True, updated_at__gt=Now() - BELIEVED_FOR)
    down = UavLink.objects.filter(uav__in=uav_ids, is_in_air=False).values_list("uav_id", flat=True)
    return set(by_link.values_list("uav_id", flat=True)) | (set(by_report.values_list("uav_id", flat=True)) - set(down))


def places_in_the_air(uav_ids: Collection[int]) -> dict[int, LonLat | None]:
    """Where those that `reported_in_the_air` names were last; None where they have told no place."""
    in_the_air = reported_in_the_air(uav_ids)
    reported = UavWatch.objects.filter(uav__in=in_the_air, measured__position__isnull=False).values_list(
        "uav_id", "measured__position__position"
    )
    return dict.fromkeys(in_the_air) | {uav_id: LonLat(*place) for uav_id, place in reported}


def reported_on_the_ground(uav_ids: Collection[int]) -> set[int]:
    """Of these UAVs, by link, as far as it was heard lately; not those to which was sent since what may have set them in motion."""
    moved = UavCommand.objects.filter(uav=OuterRef("uav"), kind__in=SETS_IN_MOTION, sent_at__gt=OuterRef("last_message_at"))
    links = UavLink.objects.filter(~Exists(moved), uav__in=uav_ids, is_in_air=False, last_message_at__gt=Now() - BELIEVED_FOR)
    return set(links.values_list("uav_id", flat=True))


def never_connected(uav_ids: Collection[int]) -> set[int]:
    """Of these UAVs, neither by a link nor by a report."""
    by_link = UavLink.objects.filter(uav__in=uav_ids, last_message_at__isnull=False).values_list("uav_id", flat=True)
    by_report = UavWatch.objects.filter(uav__in=uav_ids, measured__isnull=False).values_list("uav_id", flat=True)
    return set(uav_ids) - set(by_link) - set(by_report)


def down_off_plan(uav_ids: Collection[int]) -> set[int]:
    """Of these UAVs those with an open alert that they are down where their flight does not end: only a person closes it."""
    return set(Alert.objects.filter(uav__in=uav_ids, code=down.CODE, closed_at=None).values_list("uav_id", flat=True))
