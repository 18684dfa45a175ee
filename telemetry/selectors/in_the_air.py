"""UAVs in the air, on the ground, down off plan, or never connected, by their last messages."""

from collections.abc import Collection
from datetime import timedelta

from django.db.models import Exists, OuterRef
from django.db.models.functions import Now

from inspection.geodesy import LonLat
from missions.command_rules import SETS_IN_MOTION
from missions.models import UavCommand
from telemetry.alerting.detectors import down
from telemetry.models import Alert, UavLink, UavWatch

BELIEVED_FOR = timedelta(minutes=10)  # after the last message: longer flights in silence are rare


def reported_in_the_air(uav_ids: Collection[int]) -> set[int]:
    """Return those of the UAVs that are in the air, by link or by newest report."""
    by_link = UavLink.objects.filter(uav__in=uav_ids, is_in_air=True, last_message_at__gt=Now() - BELIEVED_FOR)
    by_report = UavWatch.objects.filter(uav__in=uav_ids, measured__state__is_in_air=True, updated_at__gt=Now() - BELIEVED_FOR)
    down = UavLink.objects.filter(uav__in=uav_ids, is_in_air=False).values_list("uav_id", flat=True)
    return set(by_link.values_list("uav_id", flat=True)) | (set(by_report.values_list("uav_id", flat=True)) - set(down))


def places_in_the_air(uav_ids: Collection[int]) -> dict[int, LonLat | None]:
    """Return the last position of those in the air; None if none was reported."""
    in_the_air = reported_in_the_air(uav_ids)
    reported = UavWatch.objects.filter(uav__in=in_the_air, measured__position__isnull=False).values_list(
        "uav_id", "measured__position__position"
    )
    return dict.fromkeys(in_the_air) | {uav_id: LonLat(*place) for uav_id, place in reported}


def reported_on_the_ground(uav_ids: Collection[int]) -> set[int]:
    """Return those of the UAVs whose link recently reported the ground, unless a command that may move them was sent since."""
    moved = UavCommand.objects.filter(uav=OuterRef("uav"), kind__in=SETS_IN_MOTION, sent_at__gt=OuterRef("last_message_at"))
    links = UavLink.objects.filter(~Exists(moved), uav__in=uav_ids, is_in_air=False, last_message_at__gt=Now() - BELIEVED_FOR)
    return set(links.values_list("uav_id", flat=True))


def never_connected(uav_ids: Collection[int]) -> set[int]:
    """Return those of the UAVs without a message on any link."""
    by_link = UavLink.objects.filter(uav__in=uav_ids, last_message_at__isnull=False).values_list("uav_id", flat=True)
    by_report = UavWatch.objects.filter(uav__in=uav_ids, measured__isnull=False).values_list("uav_id", flat=True)
    return set(uav_ids) - set(by_link) - set(by_report)


def down_off_plan(uav_ids: Collection[int]) -> set[int]:
    """Return those of the UAVs with an open alert that they are down off plan, which only a user closes."""
    return set(Alert.objects.filter(uav__in=uav_ids, code=down.CODE, closed_at=None).values_list("uav_id", flat=True))
