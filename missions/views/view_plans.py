"""Cameras of the catalogue, and plans of photos that are returned without being stored."""

from django.http import Http404
from django.utils.translation import gettext as _
from drf_spectacular.utils import extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.models import Asset
from missions.selectors.photo_flights import NotATower
from missions.serializers.view_plans import (
    CameraCatalogueSerializer,
    ViewPlanInputSerializer,
    ViewPlanSerializer,
    catalogue_json,
    views_request,
)
from missions.services.view_plans import plan_views
from planning.views.catalogue import catalogue
from planning.views.detail_views import TooManyPhotos
from planning.views.view_flight import NoWay
from workspace.api.errors import ApiProblem
from workspace.api.renderers import FastJSONRenderer
from workspace.api.signed_in import SignedInRequest
from workspace.api.throttling import ScopedRate
from workspace.models import Role


class CameraCatalogue(APIView):
    @extend_schema(
        operation_id="list_catalogue_cameras",
        summary="Common inspection cameras, with the source of each figure",
        responses=CameraCatalogueSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        return Response({"results": [catalogue_json(own) for own in catalogue().values()]})


class ViewPlans(APIView):
    write_roles = frozenset(Role)
    renderer_classes = [FastJSONRenderer]
    throttle_classes = [ScopedRate]
    throttle_scope = "view-plans"

    @extend_schema(
        operation_id="plan_views",
        summary="Plan photos of a tower or its wires at a ground sample distance, clear of the wires",
        description="The fewest photos found that show what can be shown of the tower, or photos of its wires with an overlap of 30 %; "
        "the flight through them, and the coverage of each component. The tower is modelled from its tags; wires count with their "
        "swing. Nothing is stored.",
        request=ViewPlanInputSerializer,
        responses=ViewPlanSerializer,
    )
    def post(self, request: SignedInRequest) -> Response:
        values = ViewPlanInputSerializer.read(request.data)
        asset = Asset.objects.filter(pk=values["asset"], vanished_at=None).first()
        if asset is None:
            raise Http404
        try:
            plan = plan_views(asset=asset, views=views_request(values))
        except NotATower as error:
            message = _("Photos are planned of power towers that carry a line.")
            raise ApiProblem(400, "not_a_tower", message, details={"asset": [message]}) from error
        except TooManyPhotos as error:
            message = _("It would take too many photos. Choose a coarser ground sample distance, or a camera with more pixels.")
            raise ApiProblem(400, "too_many_photos", message, details={"gsd_mm": [message]}) from error
        except NoWay as error:
            message = _("No flight keeps clear of wires, ground and the greatest height here.")
            raise ApiProblem(409, "no_way", message) from error
        return Response(plan)
