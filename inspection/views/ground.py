"""The map data as a whole, and its tiles."""

import json
from hashlib import sha256
from typing import Any

import shapely
from django.http import Http404, HttpResponse
from django.utils.cache import get_conditional_response
from django.utils.translation import get_language
from django.utils.translation import gettext as _
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework import serializers
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection import selectors
from inspection.geodesy.geometry_validator import GeometryFault
from inspection.models import AssetKind
from inspection.selectors import Box, GroundSummary, NoSuchTile, ground_dataset_version
from inspection.selectors.scene import RECIPE, UnfitBox, check_box, scene_in
from inspection.serializers.edits import GeometryCheckResultSerializer, GeometryCheckSerializer
from inspection.serializers.scene import SceneSerializer, scene_json
from inspection.services.imports.geometry import area_m2, asset_shape, length_m, zone_shape
from inspection.views.parameters import TWO_LON_LATS, box_of, invalid
from workspace.api.permissions import CURATORS
from workspace.api.renderers import OneAnswer

TILE_MAX_AGE_S = 600
TILE_TYPE = "application/vnd.mapbox-vector-tile"


class SceneOfBox(APIView):
    throttle_scope = "scene"

    @extend_schema(
        operation_id="get_scene",
        summary="What stands in a box, for the 3D view",
        description="Terrain, supports with arms, spans with sag, railways, bridges and zones with their limits, in WGS84 and metres. "
        "Sides of the box are between 50 m and 40 km; what goes beyond the limits of number is counted in left_out. "
        "The ETag changes with the ground.",
        parameters=[OpenApiParameter("bbox", TWO_LON_LATS, required=True, description="west,south,east,north in degrees, west < east")],
        responses={200: SceneSerializer, 304: OpenApiResponse(description="The ground has not changed.")},
    )
    def get(self, request: Request) -> HttpResponse:
        box = box_of(request)
        if box is None:
            raise invalid("bbox", _("Four numbers are needed: west,south,east,north."))
        try:
            check_box(box)
        except UnfitBox as error:
            raise invalid("bbox", _(str(error))) from error
        etag = _etag(box)
        not_changed = get_conditional_response(request._request, etag=etag)
        response = not_changed if not_changed is not None else Response(scene_json(scene_in(box)))
        response["ETag"] = etag
        response["Cache-Control"] = "private, no-cache"  # stored, but revalidated: zones may be new
        return response


def _etag(box: Box) -> str:
    """Return the ETag of the map data, the box and the language of the labels."""
    revision, changed_at = ground_dataset_version()
    said = f"{revision}-{changed_at.timestamp() if changed_at else 0:.6f}-{RECIPE}-{box}-{get_language()}"
    return f'"{sha256(said.encode()).hexdigest()[:32]}"'


class GeometryCheck(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="check_geometry",
        summary="Check a geometry that is being drawn; nothing is stored",
        request=GeometryCheckSerializer,
        responses=GeometryCheckResultSerializer,
    )
    def post(self, request: Request) -> Response:
        body = GeometryCheckSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        kind, geometry, circle = (body.validated_data.get(name) for name in ("kind", "geometry", "circle"))
        answer: dict[str, Any] = {"valid": True, "fault": None, "geometry": None, "length_m": None, "area_m2": None}
        try:
            shape = zone_shape(geometry, circle)[0] if kind == "zone" else asset_shape(AssetKind(kind), geometry)
        except GeometryFault as fault:
            position = list(fault.position) if fault.position else None
            answer |= {"valid": False, "fault": {"place": fault.place, "message": fault.message, "position": position}}
        else:
            answer |= {"geometry": json.loads(shapely.to_geojson(shape)), "length_m": length_m(shape), "area_m2": area_m2(shape)}
        return Response(answer)


class GraphSummarySerializer(serializers.Serializer):
    version = serializers.IntegerField()
    nodes = serializers.IntegerField()
    edges = serializers.IntegerField()
    built_at = serializers.DateTimeField()
    is_current = serializers.BooleanField(help_text="false while the ground has changed and the next graph is not yet built")


class GroundSerializer(serializers.Serializer):
    revision = serializers.IntegerField()
    graph = GraphSummarySerializer(allow_null=True)
    extent = serializers.ListField(child=serializers.FloatField(), allow_null=True, help_text="west, south, east, north")
    counts = serializers.DictField(child=serializers.IntegerField(), help_text="by kind of asset, and `zone`")
    attribution = serializers.ListField(child=serializers.CharField())
    is_synthetic = serializers.BooleanField(help_text="some of the data is made, not real")
    has_terrain = serializers.BooleanField()


def ground_json(summary: GroundSummary) -> dict[str, Any]:
    graph = summary.graph
    return {
        "revision": summary.revision,
        "graph": graph
        and {
            "version": graph.version,
            "nodes": graph.nodes,
            "edges": graph.edges,
            "built_at": graph.built_at,
            "is_current": summary.graph_is_current,
        },
        "extent": summary.extent,
        "counts": summary.counts,
        "attribution": summary.attribution,
        "is_synthetic": summary.is_synthetic,
        "has_terrain": summary.has_terrain,
    }


class GroundView(APIView):
    @extend_schema(operation_id="get_ground", summary="What is known of the ground, and the graph over it", responses=GroundSerializer)
    def get(self, request: Request) -> Response:
        return Response(ground_json(selectors.ground_summary()))


class Tile(APIView):
    content_negotiation_class = OneAnswer
    throttle_scope = "tiles"

    @extend_schema(
        operation_id="get_tile",
        summary="A vector tile of assets and zones",
        description="Layers lines, railways, bridges, bridge_points, towers, zones, zone_labels, counts; empty where there is nothing. "
        "Labels and details are in the reader's language. The ETag changes with the ground and the language.",
        parameters=[
            OpenApiParameter(
                "of",
                str,
                description="The version of the map data that a page shows; browsers keep a tile of the present one for ten minutes",
            )
        ],
        responses={(200, TILE_TYPE): OpenApiTypes.BINARY, 304: OpenApiResponse(description="The tile has not changed.")},
    )
    def get(self, request: Request, zoom: int, column: int, row: int) -> HttpResponse:
        version = selectors.ground_dataset_version()
        dataset_version, changed_at = selectors.tiles_version(version), version[1]
        etag = f'"{dataset_version}"'
        not_changed = get_conditional_response(request._request, etag=etag)
        if not_changed is not None:
            response = not_changed
        else:
            try:
                tile = selectors.tile_of_version(zoom, column, row, dataset_version if changed_at else None)
                response = HttpResponse(tile, content_type=TILE_TYPE)
            except NoSuchTile as error:
                raise Http404 from error
        response["ETag"] = etag
        is_of_version = changed_at is not None and request.query_params.get("of") == dataset_version
        # A page that is open does not learn of a new zone here: it asks again after that time.
        response["Cache-Control"] = f"private, max-age={TILE_MAX_AGE_S}" if is_of_version else "private, no-cache"
        return response
