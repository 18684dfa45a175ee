"""What a UAV proves itself with: made, replaced, revoked."""

from django.shortcuts import get_object_or_404
from drf_spectacular.utils import extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from missions import fleet_selectors, services
from missions.models import CredentialKind
from missions.serializers.fleet import CredentialInputSerializer, CredentialPageSerializer, NewCredentialSerializer, credential_json
from missions.views.uavs import uav_or_404
from workspace.paging import page_of
from workspace.schema import PAGE_PARAMETERS
from workspace.signed_in import SignedInRequest


class UavCredentials(APIView):
    @extend_schema(
        operation_id="list_uav_credentials",
        summary="Tokens and keys of a UAV, the newest first; never the secrets themselves",
        parameters=PAGE_PARAMETERS,
        responses=CredentialPageSerializer,
    )
    def get(self, request: SignedInRequest, uav_id: int) -> Response:
        credentials = fleet_selectors.credentials_of_uav(uav_or_404(request.user, uav_id))
        page = page_of(request, credentials, order=("-created_at", "-pk"), default_limit=20)
        return Response({"results": [credential_json(credential) for credential in page.rows], "next": page.next})

    @extend_schema(
        operation_id="make_uav_credential",
        summary="Make a link token or a MAVLink signing key",
        description=(
            "The answer has the secret, this once. One of the same kind that was in force is revoked. There is no Idempotency-Key here, "
            "because kept answers would hold the secret: asking again makes another one."
        ),
        request=CredentialInputSerializer,
        responses={201: NewCredentialSerializer},
    )
    def post(self, request: SignedInRequest, uav_id: int) -> Response:
        uav = uav_or_404(request.user, uav_id)
        serializer = CredentialInputSerializer(data=request.data)
        serializer.is_valid(raise_exception=True)
        made = services.make_credential(uav=uav, actor=request.user, kind=CredentialKind(serializer.validated_data["kind"]))
        made.credential.refresh_from_db()
        return Response(credential_json(made.credential) | {"secret": made.secret}, status=201, headers={"Cache-Control": "no-store"})


class UavCredentialDetail(APIView):
    @extend_schema(operation_id="revoke_uav_credential", summary="Revoke a token or a key", responses={204: None})
    def delete(self, request: SignedInRequest, uav_id: int, credential_id: int) -> Response:
        credentials = fleet_selectors.credentials_of_uav(uav_or_404(request.user, uav_id)).select_related("uav__organisation")
        services.revoke_credential(credential=get_object_or_404(credentials, pk=credential_id), actor=request.user)
        return Response(status=204)
