"""The API's doors to the ground: assets, zones, tiles."""

from math import isfinite
from typing import Any, cast

from django.http import Http404, HttpResponse
from django.utils.cache import get_conditional_response
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.negotiation import BaseContentNegotiation
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection import selectors, serializers
from inspection.models import Asset, AssetKind, NoFlyZone
from inspection.selectors import Box, NoSuchTile
from inspection.selectors.asset_search import BEST_FIRST, with_match_rank
from workspace.errors import ApiProblem
from workspace.paging import page_of
from workspace.schema import PAGE_PARAMETERS

LONGEST_TEXT = 100
TILE_TYPE = "application/vnd.mapbox-vector-tile"
BOX = OpenApiParameter("bbox", str, description="west,south,east,north in degrees; west > east crosses the 180th meridian")


def _invalid(parameter: str, message: str) -> ApiProblem:
    return ApiProblem(400, "invalid", f"{parameter}: {message}", details={parameter: [message]})


def _box(request: Request) -> Box | None:
    text = request.query_params.get("bbox", "")
    if not text:
        return None
    try:
        west, south, east, north = (float(part) for part in text.split(","))
    except ValueError as error:
        raise _invalid("bbox", "Four numbers are needed: west,south,east,north.") from error
    if not all(map(isfinite, (west, south, east, north))):
        raise _invalid("bbox", "Four finite numbers are needed.")
    if not (-180 <= west <= 180 and -180 <= east <= 180 and -90 <= south <= north <= 90):
        raise _invalid("bbox", "Longitudes go from -180 to 180, latitudes from -90 to 90, and south is not above north.")
    return west, south, east, north


def _kinds(request: Request) -> list[AssetKind]:
    try:
        return [AssetKind(kind.strip()) for kind in request.query_params.get("kind", "").split(",") if kind.strip()]
    except ValueError as error:
        raise _invalid("kind", f"Known kinds are {', '.join(AssetKind.values)}.") from error


def _text(request: Request) -> str:
    text = request.query_params.get("text", "").strip()
    if len(text) > LONGEST_TEXT or not text.isprintable():
        raise _invalid("text", f"At most {LONGEST_TEXT} printable characters.")
    return text


class AssetList(APIView):
    @extend_schema(
        operation_id="list_assets",
        summary="Assets: towers, lines, railways, bridges",
        parameters=[
            BOX,
            OpenApiParameter("kind", str, description=f"one or several of {', '.join(AssetKind.values)}, with commas"),
            OpenApiParameter("text", str, description='words in name, ref or operator; "138 kV"; an OSM id such as w123; best first'),
            *PAGE_PARAMETERS,
        ],
        responses=serializers.AssetCollectionSerializer,
    )
    def get(self, request: Request) -> Response:
        text = _text(request)
        assets = selectors.assets_on_the_ground(box=_box(request), kinds=_kinds(request), text=text).only(*serializers.FIELDS_OF_AN_ASSET)
        page = page_of(request, with_match_rank(assets, text=text), order=BEST_FIRST) if text else page_of(request, assets)
        features = [serializers.asset_feature(asset) for asset in page.rows]
        return Response({"type": "FeatureCollection", "features": features, "next": page.next})


class AssetDetail(APIView):
    @extend_schema(
        operation_id="get_asset", summary="One asset with its tags and source", responses=serializers.AssetDetailFeatureSerializer
    )
    def get(self, request: Request, asset_id: int) -> Response:
        try:
            return Response(serializers.asset_detail_feature(selectors.asset_with_geometry(asset_id)))
        except Asset.DoesNotExist as error:
            raise Http404 from error


class ZoneList(APIView):
    @extend_schema(
        operation_id="list_zones",
        summary="No-fly zones",
        parameters=[BOX, *PAGE_PARAMETERS],
        responses=serializers.ZoneCollectionSerializer,
    )
    def get(self, request: Request) -> Response:
        page = page_of(request, selectors.zones(box=_box(request)))
        features = [serializers.zone_feature(zone) for zone in page.rows]
        return Response({"type": "FeatureCollection", "features": features, "next": page.next})


class ZoneDetail(APIView):
    @extend_schema(
        operation_id="get_zone", summary="One no-fly zone with all its source says", responses=serializers.ZoneDetailFeatureSerializer
    )
    def get(self, request: Request, zone_id: int) -> Response:
        try:
            return Response(serializers.zone_detail_feature(selectors.zones().get(pk=zone_id)))
        except NoFlyZone.DoesNotExist as error:
            raise Http404 from error


class Ground(APIView):
    @extend_schema(
        operation_id="get_ground", summary="What is known of the ground, and the graph over it", responses=serializers.GroundSerializer
    )
    def get(self, request: Request) -> Response:
        return Response(serializers.ground_json(selectors.ground_summary()))


class _OneAnswer(BaseContentNegotiation):
    """Tiles are tiles and errors are JSON, whatever the client says that it prefers."""

    def select_parser(self, request: Request, parsers: Any) -> Any:
        return parsers[0]

    def select_renderer(self, request: Request, renderers: Any, format_suffix: str | None = None) -> Any:
        return renderers[0], renderers[0].media_type


class Tile(APIView):
    content_negotiation_class = _OneAnswer

    @extend_schema(
        operation_id="get_tile",
        summary="A vector tile of assets and zones",
        description="Layers lines, railways, bridges, bridge_points, towers, zones, zone_labels; empty where there is nothing. "
        "The ETag changes with the ground.",
        responses={(200, TILE_TYPE): OpenApiTypes.BINARY, 304: OpenApiResponse(description="The tile has not changed.")},
    )
    def get(self, request: Request, zoom: int, column: int, row: int) -> HttpResponse:
        revision, changed_at = selectors.ground_edition()
        etag = f'"{revision}-{changed_at.timestamp() if changed_at else 0:.6f}-{selectors.TILE_RECIPE}"'
        not_changed = get_conditional_response(request._request, etag=etag)
        if not_changed is not None:
            response = cast(HttpResponse, not_changed)
        else:
            try:
                response = HttpResponse(selectors.vector_tile(zoom, column, row), content_type=TILE_TYPE)
            except NoSuchTile as error:
                raise Http404 from error
        response["ETag"] = etag
        response["Cache-Control"] = "private, no-cache"  # kept, but asked for again: a zone may have come
        return response
