"""Whether what somebody is drawing could be stored, and if not, what is wrong where."""

import json
from typing import Any

import shapely
from drf_spectacular.utils import extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.geodesy.geometry_validator import GeometryFault
from inspection.models import AssetKind
from inspection.serializers.edits import GeometryCheckSerializer, GeometryVerdictSerializer
from inspection.services.geometry_input import area_m2, asset_shape, length_m, zone_shape
from workspace.permissions import CURATORS


class GeometryCheck(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="check_geometry",
        summary="Check a geometry that is being drawn; nothing is stored",
        request=GeometryCheckSerializer,
        responses=GeometryVerdictSerializer,
    )
    def post(self, request: Request) -> Response:
        body = GeometryCheckSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        kind, geometry, circle = (body.validated_data.get(name) for name in ("kind", "geometry", "circle"))
        verdict: dict[str, Any] = {"valid": True, "fault": None, "geometry": None, "length_m": None, "area_m2": None}
        try:
            shape = zone_shape(geometry, circle)[0] if kind == "zone" else asset_shape(AssetKind(kind), geometry)
        except GeometryFault as fault:
            position = list(fault.position) if fault.position else None
            verdict |= {"valid": False, "fault": {"place": fault.place, "message": fault.message, "position": position}}
        else:
            verdict |= {"geometry": json.loads(shapely.to_geojson(shape)), "length_m": length_m(shape), "area_m2": area_m2(shape)}
        return Response(verdict)
