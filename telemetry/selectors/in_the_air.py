"""Which UAVs are in the air by their last word."""

from collections.abc import Collection
from datetime import timedelta

from django.db.models.functions import Now

from inspection.geodesy import LonLat
from telemetry.models import UavLink, UavWatch

BELIEVED_FOR = timedelta(minutes=10)  # after its last word: longer flights without a word are rare


def reported_in_the_air(uav_ids: Collection[int]) -> set[int]:
    """Of these UAVs, by link or by their newest report."""
    by_link = UavLink.objects.filter(uav__in=uav_ids, is_in_air=True, heard_at__gt=Now() - BELIEVED_FOR)
    by_report = UavWatch.objects.filter(uav__in=uav_ids, measured__state__is_in_air=True, updated_at__gt=Now() - BELIEVED_FOR)
    down = UavLink.objects.filter(uav__in=uav_ids, is_in_air=False).values_list("uav_id", flat=True)
    return set(by_link.values_list("uav_id", flat=True)) | (set(by_report.values_list("uav_id", flat=True)) - set(down))


def places_in_the_air(uav_ids: Collection[int]) -> dict[int, LonLat | None]:
    """Where those that `reported_in_the_air` names were last; None where they have told no place."""
    in_the_air = reported_in_the_air(uav_ids)
    told = UavWatch.objects.filter(uav__in=in_the_air, measured__position__isnull=False).values_list(
        "uav_id", "measured__position__position"
    )
    return dict.fromkeys(in_the_air) | {uav_id: LonLat(*place) for uav_id, place in told}
