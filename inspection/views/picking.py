"""Endpoints for selecting many assets at once. Nothing is stored."""

from dataclasses import replace
from itertools import islice
from typing import Any

from django.contrib.gis.geos import GEOSGeometry
from django.http import Http404
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.geodesy import LonLat
from inspection.geodesy.stretches import LinePart
from inspection.models import Asset, AssetKind
from inspection.selectors import part_label, picking
from inspection.serializers.assets import FIELDS_OF_AN_ASSET
from inspection.serializers.picking import (
    BridgesOutputSerializer,
    LinePartsOutputSerializer,
    LookupInputSerializer,
    LookupOutputSerializer,
    PartsInputSerializer,
    SupportsOutputSerializer,
    WithinInputSerializer,
    WithinOutputSerializer,
    picked_asset,
    picked_assets,
)
from inspection.views.parameters import TWO_LON_LATS, invalid, positions_of
from workspace.api.errors import ApiProblem
from workspace.api.paging import asked_choice, asked_flag
from workspace.api.whole_numbers import WholeNumber
from workspace.models import Role

MAX_CHOICES = 20
PART_M = WholeNumber("part_m", f"about how long a part is, metres; {picking.DEFAULT_PART_M:.0f} by default", minimum=100, maximum=1_000_000)
FROM = WholeNumber("from", "id of the support where it begins")
TO = WholeNumber("to", "id of the support where it ends")


def _asset(asset_id: int, *kinds: AssetKind) -> Asset:
    asset = Asset.objects.select_related("line").filter(pk=asset_id, kind__in=kinds, vanished_at=None).first()
    if asset is None:
        raise Http404
    return asset


def _support_of(request: Request, end: WholeNumber) -> Asset | None:
    key = end.asked(request)
    if key is None:
        return None
    support = Asset.objects.filter(pk=key, kind=AssetKind.TOWER, vanished_at=None).first()
    if support is None:
        raise invalid(end.name, _("There is no such tower or pole."))
    return support


def _area_of(polygon: dict[str, Any]) -> GEOSGeometry:
    ring = [position[:2] for position in polygon["coordinates"][0]]
    if not all(-540.0 <= longitude <= 540.0 and -90.0 <= latitude <= 90.0 for longitude, latitude in ring):
        raise invalid("polygon", _("A position is not on the globe."))
    try:
        area = picking.area_drawn(ring)
    except picking.TooTangled as error:
        raise invalid("polygon", _("It crosses itself too often.")) from error
    if area is None:
        raise invalid("polygon", _("It encloses nothing."))
    return area


class AssetLookup(APIView):
    write_roles = frozenset(Role)

    @extend_schema(
        operation_id="lookup_assets",
        summary="Which assets a list of references means",
        request=LookupInputSerializer,
        responses=LookupOutputSerializer,
    )
    def post(self, request: Request) -> Response:
        body = LookupInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        asked = {picking.plain_ref(ref): ref for ref in reversed(body.validated_data["refs"])}
        refs = list(reversed(asked))
        found = picking.assets_called(refs, kinds=body.validated_data.get("kinds", ()))
        rows = {row["id"]: row for row in picked_assets(pk for ref in refs for pk in islice(found[ref], MAX_CHOICES))}
        results = [
            {
                "ref": asked[ref],
                "match": "none" if not found[ref] else "found" if len(found[ref]) == 1 else "several",
                "count": len(found[ref]),
                "assets": [rows[pk] for pk in found[ref][:MAX_CHOICES] if pk in rows],
            }
            for ref in refs
        ]
        return Response({"results": results})


class AssetsWithin(APIView):
    write_roles = frozenset(Role)

    @extend_schema(
        operation_id="list_assets_within",
        summary="Assets that stand in an area drawn by hand",
        request=WithinInputSerializer,
        responses=WithinOutputSerializer,
    )
    def post(self, request: Request) -> Response:
        body = WithinInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        area = _area_of(body.validated_data["polygon"])
        kinds = body.validated_data.get("kinds") or [AssetKind.TOWER, AssetKind.BRIDGE]
        assets = picking.assets_in_area(area, kinds)
        rows = list(assets.select_related("line").only(*FIELDS_OF_AN_ASSET)[: picking.MAX_IN_AN_AREA])
        count = len(rows) if len(rows) < picking.MAX_IN_AN_AREA else assets.count()
        return Response({"count": count, "assets": [picked_asset(asset) for asset in rows]})


class LineSupports(APIView):
    @extend_schema(
        operation_id="list_line_supports",
        summary="Towers and poles of a line in order, or those from one to another",
        parameters=[FROM.documented, TO.documented],
        responses=SupportsOutputSerializer,
    )
    def get(self, request: Request, asset_id: int) -> Response:
        line = _asset(asset_id, AssetKind.LINE)
        start, end = _support_of(request, FROM), _support_of(request, TO)
        if (start is None) != (end is None):
            raise invalid("from" if start is None else "to", _("Both ends are needed, or none."))
        if start is None or end is None:
            return Response({"supports": picked_assets(picking.supports_of_line(line)), "parts": [], "length_m": line.length_m})
        try:
            supports = picking.supports_between(line, start.pk, end.pk)
        except picking.NotOnTheLine as error:
            raise ApiProblem(400, "not_on_line", _("Both towers must be on this line.")) from error
        return Response({"supports": picked_assets(supports), "parts": [], "length_m": None})


class StretchAlongLines(APIView):
    @extend_schema(
        operation_id="get_stretch",
        summary="What is between two towers along the lines, also over several lines of a circuit",
        parameters=[replace(end, required=True).documented for end in (FROM, TO)],
        responses=SupportsOutputSerializer,
    )
    def get(self, request: Request) -> Response:
        start, end = _support_of(request, FROM), _support_of(request, TO)
        if start is None or end is None:
            raise invalid("from" if start is None else "to", _("Both ends are needed."))
        if start == end:
            raise invalid("to", _("Both ends are the same tower."))
        try:
            stretch = picking.stretch_along_lines(start, end)
        except picking.NoWayAlongLines as error:
            raise ApiProblem(404, "no_way_along_lines", _("No line leads from one tower to the other.")) from error
        lines = Asset.objects.select_related("line").in_bulk({part.line for part in stretch.parts})
        parts = [
            _part_json(lines[part.line], part.start, part.end, part.length_m, picking.label_between(lines[part.line], part.start, part.end))
            for part in stretch.parts
            if part.line in lines
        ]
        return Response({"supports": picked_assets(stretch.supports), "parts": parts, "length_m": stretch.length_m})


def _part_json(line: Asset, start: LonLat, end: LonLat, length_m: float, label: str) -> dict[str, Any]:
    return {"line": picked_asset(line), "label": label, "stretch": [list(start), list(end)], "length_m": length_m}


def _part_of(line: Asset, part: LinePart) -> dict[str, Any]:
    return _part_json(line, part.start, part.end, part.length_m, part_label(line, part.from_m, part.to_m))


class LineParts(APIView):
    @extend_schema(
        operation_id="list_line_parts",
        summary="A line or railway in parts that several UAVs can share",
        parameters=[
            PART_M.documented,
            OpenApiParameter("ends", TWO_LON_LATS, description="lon,lat,lon,lat: only the stretch between the places nearest to these"),
        ],
        responses=LinePartsOutputSerializer,
    )
    def get(self, request: Request, asset_id: int) -> Response:
        line = _asset(asset_id, AssetKind.LINE, AssetKind.RAILWAY)
        part_m = PART_M.asked(request) or picking.DEFAULT_PART_M
        ends = tuple(positions_of(request, "ends", 2)) if request.query_params.get("ends") else None
        try:
            found = picking.parts_of_asset(line, part_m, ends)
        except picking.NoStretch as error:
            raise invalid("ends", _("Both ends are the same point of the line.")) from error
        except picking.NotOneLine as error:
            raise ApiProblem(400, "not_one_line", _("This asset is not drawn as one line, so it cannot be flown along.")) from error
        return Response({"parts": [_part_of(line, part) for part in found], "length_m": sum(part.length_m for part in found)})


class PartsOfLines(APIView):
    write_roles = frozenset(Role)

    @extend_schema(
        operation_id="list_parts_of_lines",
        summary="Several lines and railways in parts that UAVs can share",
        request=PartsInputSerializer,
        responses=LinePartsOutputSerializer,
    )
    def post(self, request: Request) -> Response:
        body = PartsInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        asked = dict.fromkeys(body.validated_data["assets"])
        lines = Asset.objects.select_related("line").filter(kind__in=[AssetKind.LINE, AssetKind.RAILWAY], vanished_at=None).in_bulk(asked)
        for place, key in enumerate(body.validated_data["assets"]):
            if key not in lines:
                raise invalid(f"assets.{place}", _("There is no such line or railway."))
        polygon = body.validated_data.get("polygon")
        found = picking.parts_of_assets(
            [lines[key] for key in asked], body.validated_data["most"], None if polygon is None else _area_of(polygon)
        )
        return Response({"parts": [_part_of(*part) for part in found], "length_m": sum(part.length_m for _line, part in found)})


class RailwayBridgesView(APIView):
    @extend_schema(
        operation_id="list_railway_bridges",
        summary="Bridges of a railway",
        parameters=[
            OpenApiParameter("sections", str, enum=["own", "all"], description="all: also of the joined sections of the same name"),
            OpenApiParameter("over", bool, description="true: also bridges that lead over the track"),
        ],
        responses=BridgesOutputSerializer,
    )
    def get(self, request: Request, asset_id: int) -> Response:
        railway = _asset(asset_id, AssetKind.RAILWAY)
        found = picking.bridges_of_railway(
            railway,
            all_sections=asked_choice(request, "sections", ("own", "all")) == "all",
            also_over=asked_flag(request, "over") or False,
        )
        return Response({"sections": len(found.sections), "bridges": picked_assets(found.bridges)})
