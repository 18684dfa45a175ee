"""Terrain: the models, heights, and conversion between references."""

from typing import Any

import numpy as np
from django.http import Http404
from drf_spectacular.utils import OpenApiParameter, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.geodesy.wgs84 import FloatArray
from inspection.models import DataImport, ImportKind
from inspection.selectors import ground_heights_m
from inspection.selectors.terrain import ground_truth
from inspection.selectors.terrain_models import finest_step_m, model_of, terrain_models
from inspection.selectors.zones_along import box_of_line, zones_along
from inspection.serializers.terrain import (
    GroundHeightSerializer,
    HeightsInputSerializer,
    HeightsSerializer,
    ModelCollectionSerializer,
    ProfileInputSerializer,
    ProfileSerializer,
    model_feature,
    zone_along_json,
    zone_margins_json,
)
from inspection.services.imports.terrain import remove_terrain
from inspection.terrain.heights import amsl_m, counted_from, samples_along
from inspection.views.parameters import LON_LAT, positions_of
from workspace.api.permissions import CURATORS
from workspace.api.signed_in import SignedInRequest
from workspace.models import Role

EVERYBODY = frozenset(Role)


class TerrainList(APIView):
    @extend_schema(operation_id="list_terrain", summary="Terrain models, what counts on top first", responses=ModelCollectionSerializer)
    def get(self, request: Request) -> Response:
        return Response({"type": "FeatureCollection", "features": [model_feature(model) for model in terrain_models()], "next": None})


class TerrainDetail(APIView):
    write_roles = CURATORS

    @extend_schema(operation_id="delete_terrain", summary="Take a terrain model away", responses={204: None})
    def delete(self, request: SignedInRequest, import_id: int) -> Response:
        row = DataImport.objects.filter(pk=import_id, kind=ImportKind.TERRAIN, terrain_tiles__isnull=False).first()
        if row is None:
            raise Http404
        remove_terrain(data_import=row, actor=request.user)
        return Response(status=204)


class GroundHeight(APIView):
    @extend_schema(
        operation_id="get_ground_height",
        summary="How high the ground is above sea level",
        parameters=[OpenApiParameter("position", LON_LAT, required=True, description="lon,lat in degrees")],
        responses=GroundHeightSerializer,
    )
    def get(self, request: Request) -> Response:
        [position] = positions_of(request, "position", 1)
        truth = ground_truth(np.array([position]))
        model = model_of(int(truth.imports[0]))
        return Response(
            {
                "ground_amsl_m": _known(truth.heights_m[0]),
                "vertical_datum": model and model.vertical_datum,
                "source": model and model.data_import.file_name,
            }
        )


class ProfileView(APIView):
    write_roles = EVERYBODY

    @extend_schema(
        operation_id="terrain_profile",
        summary="The ground along a line",
        description="Straight in longitude and latitude between the vertices; every vertex is one of the places. At most 5,000 places.",
        request=ProfileInputSerializer,
        responses=ProfileSerializer,
    )
    def post(self, request: Request) -> Response:
        body = ProfileInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        line = np.array(body.validated_data["line"])
        finest_m = finest_step_m(box_of_line(line))
        found = samples_along(line, max(body.validated_data.get("step_m", finest_m), finest_m))
        truth = ground_truth(found.positions)
        heights = truth.heights_m
        known = heights[~np.isnan(heights)]
        models = [model for key in np.unique(truth.imports).tolist() if (model := model_of(key)) is not None]
        return Response(
            {
                "length_m": float(found.distance_m[-1]),
                "distance_m": np.round(found.distance_m, 2).tolist(),
                "positions": np.round(found.positions, 7).tolist(),
                "ground_amsl_m": _all(heights),
                "lowest_m": float(known.min()) if len(known) else None,
                "highest_m": float(known.max()) if len(known) else None,
                "unknown": int(np.isnan(heights).sum()),
                "step_m": round(float(np.diff(found.distance_m).max()), 2),
                "vertical_datums": sorted({model.vertical_datum for model in models}),
                "sources": sorted({model.data_import.file_name for model in models}),
                "zones": [zone_along_json(stretch) for stretch in zones_along(line, body.validated_data["near_m"])],
                "zone_margins": zone_margins_json(),
            }
        )


class Heights(APIView):
    write_roles = EVERYBODY

    @extend_schema(
        operation_id="convert_heights",
        summary="Heights above ground, sea level and take-off, one from another",
        request=HeightsInputSerializer,
        responses=HeightsSerializer,
    )
    def post(self, request: Request) -> Response:
        body = HeightsInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        values = body.validated_data
        positions = np.array([*values["positions"], values.get("take_off") or values["positions"][0]])
        *ground, take_off = ground_heights_m(positions).tolist()
        zeros: dict[str, Any] = {"ground_amsl_m": np.array(ground), "take_off_amsl_m": take_off}
        heights = amsl_m(np.array(values["heights_m"]), values["reference"], **zeros)
        return Response(
            {
                "ground_amsl_m": _all(zeros["ground_amsl_m"]),
                "altitude_agl_m": _all(counted_from(heights, "AGL", **zeros)),
                "altitude_amsl_m": _all(heights),
                "altitude_relative_m": _all(counted_from(heights, "RELATIVE", **zeros)),
            }
        )


def _known(value: float) -> float | None:
    return None if np.isnan(value) else round(float(value), 3)


def _all(values: FloatArray) -> list[float | None]:
    return [_known(value) for value in values.tolist()]
