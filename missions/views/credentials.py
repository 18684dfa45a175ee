"""Making, replacing and revoking credentials of UAVs."""

from typing import Any

import qrcode
from django.shortcuts import get_object_or_404
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from accounts.login import PASSWORD_NEEDED, require_reauthentication
from missions import services
from missions.models import CredentialKind
from missions.selectors import fleet
from missions.serializers.fleet import (
    CredentialInputSerializer,
    CredentialPageSerializer,
    InsistSerializer,
    NewCredentialSerializer,
    credential_json,
)
from missions.views.problems import refusals
from missions.views.uavs import uav_or_404
from workspace.api.errors import ApiProblem
from workspace.api.paging import page_of
from workspace.api.permissions import ADMINISTRATORS, InTheBrowserAlone
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest

NEEDED_NOW = OpenApiResponse(
    description="The UAV flies, or a command or mission is on its way to it: an administrator may insist by `insist_reason`."
)


class UavCredentials(APIView):
    permission_classes = [InTheBrowserAlone]

    @extend_schema(
        operation_id="list_uav_credentials",
        summary="Tokens and keys of a UAV, the newest first; never the secrets themselves",
        parameters=PAGE_PARAMETERS,
        responses=CredentialPageSerializer,
    )
    def get(self, request: SignedInRequest, uav_id: int) -> Response:
        credentials = fleet.credentials_of_uav(uav_or_404(request.user, uav_id))
        page = page_of(request, credentials, order=("-created_at", "-pk"), default_limit=20)
        return Response({"results": [credential_json(credential) for credential in page.rows], "next": page.next})

    @extend_schema(
        operation_id="make_uav_credential",
        summary="Make a link token or a MAVLink signing key",
        description=(
            "The answer has the secret, this once. One of the same kind that was in force counts until the new one was used. Not with a "
            "token, and within 15 min of saying one's password. There is no Idempotency-Key here, because kept answers would hold the "
            "secret: asking again makes another one."
        ),
        request=CredentialInputSerializer,
        responses={201: NewCredentialSerializer, 403: PASSWORD_NEEDED, 409: NEEDED_NOW},
    )
    def post(self, request: SignedInRequest, uav_id: int) -> Response:
        require_reauthentication(request)
        uav = uav_or_404(request.user, uav_id)
        if uav.twin_of_id is not None:
            raise ApiProblem(409, "simulated_twin", _("The key of a simulated twin is made by the simulation that flies it."))
        serializer = CredentialInputSerializer(data=request.data)
        serializer.is_valid(raise_exception=True)
        values = serializer.validated_data
        with refusals():
            made = services.make_credential(
                uav=uav, actor=request.user, kind=CredentialKind(values["kind"]), insist_reason=_insist_reason(request, values)
            )
        made.credential.refresh_from_db()
        once = {"secret": made.secret, "secret_qr": qr_rows(made.secret)}
        return Response(credential_json(made.credential) | once, status=201, headers={"Cache-Control": "no-store"})


class UavCredentialDetail(APIView):
    permission_classes = [InTheBrowserAlone]

    @extend_schema(
        operation_id="revoke_uav_credential",
        summary="Revoke a token or a key",
        description="It counts no more at once. Not with a token, and within 15 min of saying one's password.",
        parameters=[InsistSerializer],
        responses={204: None, 403: PASSWORD_NEEDED, 409: NEEDED_NOW},
    )
    def delete(self, request: SignedInRequest, uav_id: int, credential_id: int) -> Response:
        require_reauthentication(request)
        serializer = InsistSerializer(data=request.query_params)
        serializer.is_valid(raise_exception=True)
        credentials = fleet.credentials_of_uav(uav_or_404(request.user, uav_id)).select_related("uav__organisation")
        credential = get_object_or_404(credentials, pk=credential_id)
        with refusals():
            services.revoke_credential(
                credential=credential, actor=request.user, insist_reason=_insist_reason(request, serializer.validated_data)
            )
        return Response(status=204)


def _insist_reason(request: SignedInRequest, values: dict[str, Any]) -> str:
    """Return the reason to insist. Raises ApiProblem 403 for a reason of a user who is no administrator."""
    reason = str(values.get("insist_reason", ""))
    if reason and request.user.role not in ADMINISTRATORS:
        raise ApiProblem(403, "permission_denied", _("Only administrators replace or revoke it now."))
    return reason


def qr_rows(text: str) -> list[str]:
    """Return the modules of the QR code of a text, a row each: "1" is dark. The page adds the quiet zone."""
    code = qrcode.QRCode(error_correction=qrcode.ERROR_CORRECT_M, border=0)
    code.add_data(text)
    return ["".join("1" if dark else "0" for dark in row) for row in code.get_matrix()]
