"""Assets and zones as lists."""

import math
import re
from collections.abc import Iterable
from typing import TYPE_CHECKING, TypedDict

from django.contrib.gis.db.models import GeometryField
from django.contrib.gis.db.models.functions import AsGeoJSON, Distance
from django.contrib.gis.geos import MultiPolygon, Point, Polygon
from django.db.models import Q, QuerySet
from django.db.models.functions import Cast

from inspection.geodesy import LonLat
from inspection.models import Asset, AssetKind, AssetReference, NoFlyZone
from inspection.network.zones.zone_index import METRES_PER_DEGREE_LON
from inspection.selectors.asset_names import made_name

COORDINATE_DIGITS = 7  # about a centimetre

VOLTAGE = re.compile(r"(\d{1,4}(?:\.\d{1,3})?)\s*kV\b", re.IGNORECASE)
KILOVOLTS = re.compile(r"\d{1,4}(?:\.\d{1,3})?")  # alone: a reference, or a voltage
# Columns of the line that is read with a support.
UNREAD_OF_A_LINE = {f"line__{name}" for name in ("geometry", "centre", "node_osm_ids", "tags", "parts")}
OSM_KEY = re.compile(r"([nwr])(\d{1,18})", re.IGNORECASE)

Box = tuple[float, float, float, float]  # west, south, east, north; west > east crosses the 180th meridian


class AsDrawn(TypedDict):
    geometry_json: str  # GeoJSON


if TYPE_CHECKING:
    from django_stubs_ext import WithAnnotations

    DrawnAsset = WithAnnotations[Asset, AsDrawn]
    DrawnZone = WithAnnotations[NoFlyZone, AsDrawn]
else:
    DrawnAsset, DrawnZone = Asset, NoFlyZone


def assets_on_the_ground(
    *, box: Box | None = None, kinds: list[AssetKind] | None = None, text: str = "", flyable: bool | None = None
) -> QuerySet[DrawnAsset]:
    """Return the assets of the last import, with their geometry as GeoJSON text in `geometry_json`."""
    assets = Asset.objects.select_related("line").filter(vanished_at=None)
    if box is not None:
        assets = assets.filter(geometry__intersects=area_of(box))
    if kinds:
        assets = assets.filter(kind__in=kinds)
    if flyable is not None:
        assets = assets.filter(is_flyable=flyable)
    if text:
        assets = assets.filter(_text_filter(text))
    unread = {"geometry", "node_osm_ids", "parts"} | UNREAD_OF_A_LINE
    return assets.defer(*unread).annotate(geometry_json=AsGeoJSON("geometry", precision=COORDINATE_DIGITS))


def asset_with_geometry(asset_id: int) -> DrawnAsset:
    """Return one asset, including a vanished one, to which missions may still refer. Raises Asset.DoesNotExist."""
    return (
        Asset.objects.select_related("data_import", "asset_set", "line")
        .defer(*UNREAD_OF_A_LINE)
        .annotate(geometry_json=AsGeoJSON("geometry", precision=COORDINATE_DIGITS))
        .get(pk=asset_id)
    )


def assets_near(position: LonLat, within_m: float) -> list[tuple[Asset, float]]:
    """Return the assets above ground within this distance of a position, nearest first, each with its distance [m]."""
    stretched = METRES_PER_DEGREE_LON * max(math.cos(math.radians(position.lat)), 0.01)
    place = Point(position.lon, position.lat, srid=4326)
    found = Asset.objects.select_related("line").filter(vanished_at=None, geometry__dwithin=(place, within_m / stretched))
    away = Distance(Cast("geometry", GeometryField(geography=True)), place)
    near = found.exclude(kind=AssetKind.LINE, subtype="cable").annotate(away=away).order_by("away", "pk")
    near = near.defer("node_osm_ids", "parts", *UNREAD_OF_A_LINE)
    return [(asset, asset.away.m) for asset in near if asset.away.m <= within_m]


def references_of(organisation_id: int, assets: Iterable[int]) -> dict[int, AssetReference]:
    """Return the organisation's references of these assets, by primary key."""
    return {row.asset_id: row for row in AssetReference.objects.filter(organisation=organisation_id, asset__in=list(assets))}


def with_external_id(assets: QuerySet[DrawnAsset], organisation_id: int, external_id: str) -> QuerySet[DrawnAsset]:
    """Return the one asset that has this id in the organisation."""
    named = AssetReference.objects.filter(organisation=organisation_id, external_id=external_id)
    return assets.filter(pk__in=named.values("asset"))


def zones(*, box: Box | None = None, text: str = "", zone_set: int | None = None) -> QuerySet[DrawnZone]:
    """Return zones with their geometry as GeoJSON text in `geometry_json`; each word of the text is in name, identifier or reason."""
    found = NoFlyZone.objects.select_related("zone_set__data_import")
    for term in text.split():
        found = found.filter(
            Q(name__icontains=term) | Q(identifier__icontains=term) | Q(reason__icontains=term) | Q(restriction__icontains=term)
        )
    if zone_set is not None:
        found = found.filter(zone_set=zone_set)
    if box is not None:
        found = found.filter(geometry__intersects=area_of(box))
    return found.defer("geometry").annotate(geometry_json=AsGeoJSON("geometry", precision=COORDINATE_DIGITS))


def area_of(box: Box) -> Polygon | MultiPolygon:
    west, south, east, north = box
    if west <= east:
        area: Polygon | MultiPolygon = Polygon.from_bbox(box)
    else:
        area = MultiPolygon(Polygon.from_bbox((west, south, 180.0, north)), Polygon.from_bbox((-180.0, south, east, north)))
    area.srid = 4326
    return area


def _text_filter(text: str) -> Q:
    """Return a filter: every voltage in the text ("138 kV") is one of the asset's, every other word in its name, ref, operator or OSM id.

    A number alone ("138") may be either. A generated name ("Tower 18 of 41") also finds the assets with that name.
    """
    wanted = Q()
    for kilovolts in VOLTAGE.findall(text):
        wanted &= Q(voltages_v__contains=[round(float(kilovolts) * 1000)])
    for term in VOLTAGE.sub(" ", text).split():
        matches = Q(name__icontains=term) | Q(ref__icontains=term) | Q(operator__icontains=term)
        if key := OSM_KEY.fullmatch(term):
            matches |= Q(osm_type=key[1].lower(), osm_id=int(key[2]))
        if KILOVOLTS.fullmatch(term):
            matches |= Q(voltages_v__contains=[round(float(term) * 1000)])
        wanted &= matches
    made = made_name(text)
    return wanted if made is None else wanted | made.filter()
