"""Checks of returns and landings of UAVs from their present positions."""

from django.http import Http404
from django.utils import timezone
from drf_spectacular.utils import extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.models import Uav
from missions.selectors.fleet import uavs_of_organisation
from missions.views.problems import api_problems
from missions.views.uavs import uav_or_404
from telemetry.serializers.returns import LandingHereSerializer, PresentReturnsSerializer, landing_here_json, present_return_json
from telemetry.services.returns.landing_here import landing_here
from telemetry.services.returns.present_returns import present_returns
from workspace.api.signed_in import SignedInRequest
from workspace.api.whole_numbers import WholeNumber

UAVS = WholeNumber("uav", "ids of UAVs", max_values=50, required=True)


class PresentReturnsView(APIView):
    @extend_schema(
        operation_id="list_returns_now",
        summary="What UAVs meet if all of them return now",
        description="From where each is at this moment, measured or estimated, straight home at the height of its own autopilot: the"
        " ground, towers and wires, zones that apply then, the other UAVs that return with it or are in the air, and its battery at the"
        " landing.",
        parameters=[UAVS.documented],
        responses=PresentReturnsSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        uavs, now = _asked(request), timezone.now()
        with api_problems():
            found = present_returns(uavs=uavs, now=now)
        return Response(PresentReturnsSerializer({"at": now, "results": [present_return_json(one) for one in found]}).data)


class UavLanding(APIView):
    @extend_schema(
        operation_id="get_uav_landing",
        summary="What lies below a UAV that is told to land where it is",
        description="Below its place at this moment, measured or estimated, and beside it as far as that is uncertain: lines, towers,"
        " railways and bridges, zones that apply now, its height above the ground and the slope of the terrain model. Other things are not"
        " in the data.",
        responses=LandingHereSerializer,
    )
    def get(self, request: SignedInRequest, uav_id: int) -> Response:
        uav, now = uav_or_404(request.user, uav_id), timezone.now()
        return Response(LandingHereSerializer(landing_here_json(landing_here(uav=uav, now=now), now)).data)


def _asked(request: SignedInRequest) -> list[Uav]:
    """Return the UAVs in the requested order. Raises ApiProblem 400 and Http404."""
    keys = UAVS.all_asked(request)
    found = {uav.pk: uav for uav in uavs_of_organisation(request.user.organisation).filter(pk__in=keys)}
    if len(found) < len(keys):
        raise Http404
    return [found[key] for key in keys]
