"""What every page with a map gets: the regions, and where its map opens."""

from collections import Counter
from typing import Any, TypedDict

from inspection.hooks import LonLat, bases_of
from inspection.selectors import Box, map_data
from inspection.selectors.ground import RegionSummary, regions_in_use
from workspace.models import User
from workspace.pages import raster_maps


class MapView(TypedDict):
    """The middle of a map and its zoom."""

    zoom: float
    longitude: float
    latitude: float


def map_page(user: User) -> dict[str, Any]:
    """Return raster maps, the regions, the user's last view, and the extent of the region where the user works."""
    regions = regions_in_use()
    region = _current(regions, user)
    found = {"regions": [region_json(row) for row in regions], "view": user.map_view}
    return map_data() | found | ({"extent": region.extent} if region else {}) | raster_maps()


def region_json(row: RegionSummary) -> dict[str, Any]:
    return {
        "id": row.id, "name": row.name, "extent": row.extent, "counts": row.counts, "is_synthetic": row.is_synthetic,
        "attribution": row.attribution,
    }  # fmt: skip


def _current(regions: list[RegionSummary], user: User) -> RegionSummary | None:
    """Return the region of the last view; without one that of most bases of the organisation, else of the newest import."""
    view: MapView | None = user.map_view
    if view and (seen := _at(regions, (view["longitude"], view["latitude"]))):
        return seen
    with_bases = Counter(found.id for base in bases_of(user.organisation_id) if (found := _at(regions, base)))
    newest = max(regions, key=lambda region: region.newest_import, default=None)
    return next((region for region in regions if with_bases and region.id == with_bases.most_common(1)[0][0]), newest)


def _at(regions: list[RegionSummary], place: LonLat) -> RegionSummary | None:
    """Return the smallest region at a place."""
    found = [region for region in regions if _is_within(place, region.extent)]
    return min(found, key=lambda region: (region.extent[2] - region.extent[0]) * (region.extent[3] - region.extent[1]), default=None)


def _is_within(place: LonLat, box: Box) -> bool:
    return box[0] <= place[0] <= box[2] and box[1] <= place[1] <= box[3]
