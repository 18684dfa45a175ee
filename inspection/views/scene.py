"""The ground of a box for the 3D view."""

from hashlib import sha256

from django.http import HttpResponse
from django.utils.cache import get_conditional_response
from django.utils.translation import get_language
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.selectors import Box, ground_edition
from inspection.selectors.scene import RECIPE, UnfitBox, check_box, scene_in
from inspection.serializers.scene import SceneSerializer, scene_json
from inspection.views.parameters import BOX_TEXT, box_of, invalid


class SceneOfBox(APIView):
    throttle_scope = "scene"

    @extend_schema(
        operation_id="get_scene",
        summary="What stands in a box, for the 3D view",
        description="Terrain, supports with arms, spans with sag, railways, bridges and zones with their limits, in WGS84 and metres. "
        "Sides of the box are between 50 m and 40 km; what goes beyond the limits of number is counted in left_out. "
        "The ETag changes with the ground.",
        parameters=[OpenApiParameter("bbox", BOX_TEXT, required=True, description="west,south,east,north in degrees, west < east")],
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
        response["Cache-Control"] = "private, no-cache"  # kept, but asked for again: a zone may have come
        return response


def _etag(box: Box) -> str:
    """Of the ground, the box and the language of the labels."""
    revision, changed_at = ground_edition()
    said = f"{revision}-{changed_at.timestamp() if changed_at else 0:.6f}-{RECIPE}-{box}-{get_language()}"
    return f'"{sha256(said.encode()).hexdigest()[:32]}"'
