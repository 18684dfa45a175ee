"""The ground as a whole, and its tiles."""

from django.http import Http404, HttpResponse
from django.utils.cache import get_conditional_response
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection import selectors
from inspection.selectors import NoSuchTile
from inspection.serializers.ground import GroundSerializer, ground_json
from workspace.negotiation import OneAnswer

TILE_TYPE = "application/vnd.mapbox-vector-tile"


class Ground(APIView):
    @extend_schema(operation_id="get_ground", summary="What is known of the ground, and the graph over it", responses=GroundSerializer)
    def get(self, request: Request) -> Response:
        return Response(ground_json(selectors.ground_summary()))


class Tile(APIView):
    content_negotiation_class = OneAnswer
    throttle_scope = "tiles"

    @extend_schema(
        operation_id="get_tile",
        summary="A vector tile of assets and zones",
        description="Layers lines, railways, bridges, bridge_points, towers, zones, zone_labels; empty where there is nothing. "
        "The ETag changes with the ground.",
        parameters=[OpenApiParameter("of", str, description="has no effect on the answer: with another value a map asks again at once")],
        responses={(200, TILE_TYPE): OpenApiTypes.BINARY, 304: OpenApiResponse(description="The tile has not changed.")},
    )
    def get(self, request: Request, zoom: int, column: int, row: int) -> HttpResponse:
        revision, changed_at = selectors.ground_edition()
        edition = f"{revision}-{changed_at.timestamp() if changed_at else 0:.6f}-{selectors.TILE_RECIPE}"
        etag = f'"{edition}"'
        not_changed = get_conditional_response(request._request, etag=etag)
        if not_changed is not None:
            response = not_changed
        else:
            try:
                tile = selectors.tile_of_edition(zoom, column, row, edition if changed_at else None)
                response = HttpResponse(tile, content_type=TILE_TYPE)
            except NoSuchTile as error:
                raise Http404 from error
        response["ETag"] = etag
        response["Cache-Control"] = "private, no-cache"  # kept, but asked for again: a zone may have come
        return response
