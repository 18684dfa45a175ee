"""Zone sets with their sources, versions and fetches."""

from typing import TYPE_CHECKING, TypedDict

from django.db.models import Count, F, IntegerField, OuterRef, QuerySet, Subquery
from django.db.models.functions import Coalesce

from inspection.models import NoFlyZone, ZoneSet, ZoneSetVersion, ZoneSubscription
from workspace.models import Job, JobState

FETCH_TASK = "inspection.tasks.fetch_subscription"
NEWEST_VERSION_FIRST = ("-number",)
BY_NAME = ("name", "pk")


class ZoneSetCounts(TypedDict):
    """Counts in the query for sets."""

    zone_count: int
    edited_count: int
    version_count: int


if TYPE_CHECKING:
    from django_stubs_ext import WithAnnotations

    CountedZoneSet = WithAnnotations[ZoneSet, ZoneSetCounts]
else:
    CountedZoneSet = ZoneSet


def zone_sets() -> QuerySet[CountedZoneSet]:
    """Return all sets, with their numbers of zones, of edited zones and of versions."""

    def number_of(model: type[NoFlyZone | ZoneSetVersion], **condition: bool) -> Coalesce:
        rows = model._default_manager.filter(**condition, zone_set=OuterRef("pk")).order_by().values("zone_set")
        return Coalesce(Subquery(rows.annotate(number=Count("pk")).values("number"), output_field=IntegerField()), 0)

    return ZoneSet.objects.select_related("data_import__imported_by", "subscription__proposal").annotate(
        zone_count=number_of(NoFlyZone),
        edited_count=number_of(NoFlyZone, is_edited=True),
        version_count=number_of(ZoneSetVersion),
    )


def versions_of(zone_set: ZoneSet) -> QuerySet[ZoneSetVersion]:
    return zone_set.versions.select_related("data_import", "created_by").defer("content")


def zone_subscriptions() -> QuerySet[ZoneSubscription]:
    return ZoneSubscription.objects.select_related("zone_set", "proposal").annotate(name=F("zone_set__name"))


def open_fetch_of(subscription: ZoneSubscription) -> Job | None:
    """Return the open job that fetches for the subscription."""
    jobs = Job.objects.filter(task=FETCH_TASK, state__in=(JobState.QUEUED, JobState.RUNNING), parameters__subscription=subscription.pk)
    return jobs.order_by("-created_at").first()
