"""Which assets can be inspected. Nothing is stored: whoever may read the map may ask."""

from drf_spectacular.utils import extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.serializers.reachability import ReachabilityInputSerializer, ReachabilitySerializer
from missions.services.reachability import reachability
from missions.views.problems import api_problems
from workspace.models import Role
from workspace.renderers import FastJSONRenderer
from workspace.signed_in import SignedInRequest
from workspace.throttling import ScopedRate


class Reachability(APIView):
    write_roles = frozenset(Role)
    renderer_classes = [FastJSONRenderer]
    throttle_classes = [ScopedRate]
    throttle_scope = "plans"

    @extend_schema(
        operation_id="reachable_assets",
        summary="Which assets the UAVs can inspect, one flight for each, and why the others they cannot",
        description="Judged as a plan with the asset as its only target would be, on the zones that can be in force during the flight.",
        request=ReachabilityInputSerializer,
        responses=ReachabilitySerializer,
    )
    def post(self, request: SignedInRequest) -> Response:
        body = ReachabilityInputSerializer(data=request.data, context={"organisation": request.user.organisation})
        body.is_valid(raise_exception=True)
        values = body.validated_data
        with api_problems():
            return Response(reachability(request=body.to_request(), starts=values["starts"], box=values.get("box")))
