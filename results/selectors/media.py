"""Reads of media."""

from dataclasses import dataclass
from uuid import UUID

from django.db.models import QuerySet
from django.db.models.functions import Coalesce

from inspection.models import Asset, AssetKind
from inspection.selectors.picking import supports_of_line
from results.models import MediaUpload, Medium

NOT_REVIEWED = "none"


@dataclass(frozen=True, kw_only=True)
class MediaFilter:
    """Conditions of a list; None or empty for any. review: `none` for media that are not reviewed yet."""

    mission: UUID | None = None
    target: int | None = None
    asset: Asset | None = None
    uav: int | None = None
    kind: str = ""
    state: str = ""
    placement: str = ""
    review: str = ""


def media_of_organisation(organisation_id: int) -> QuerySet[Medium]:
    return Medium.objects.filter(organisation=organisation_id)


def media_that_match(organisation_id: int, wanted: MediaFilter) -> QuerySet[Medium]:
    """Return media with `shown_at`, when they were taken or else received; an asset's include those of a line's supports."""
    media = media_of_organisation(organisation_id)
    for name in ("mission", "target", "uav"):
        if (value := getattr(wanted, name)) is not None:
            media = media.filter(**{name: value})
    for name in ("kind", "state", "placement"):
        if value := getattr(wanted, name):
            media = media.filter(**{name: value})
    if wanted.asset is not None:
        media = media.filter(asset__in=keys_of_asset(wanted.asset))
    if wanted.review:
        media = media.filter(review="" if wanted.review == NOT_REVIEWED else wanted.review)
    return media.select_related("asset", "target").annotate(shown_at=Coalesce("taken_at", "received_at"))


def keys_of_asset(asset: Asset) -> tuple[int, ...]:
    """Return an asset's key and, of a line, those of its supports."""
    return (asset.pk, *(supports_of_line(asset) if asset.kind == AssetKind.LINE else ()))


def open_uploads_of_organisation(organisation_id: int) -> QuerySet[MediaUpload]:
    return MediaUpload.objects.filter(organisation=organisation_id)
