"""API endpoints of one's own passkeys."""

import json
from typing import Any

from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from accounts.login import PASSWORD_NEEDED, require_reauthentication
from accounts.passkeys import (
    MAX_PASSKEYS,
    PasskeyRefused,
    TooManyPasskeys,
    add_passkey,
    confirm_with_passkey,
    creation_options,
    remove_passkey,
)
from accounts.second_factors import passkeys_of
from accounts.serializers import PasskeyInputSerializer, PasskeyListSerializer, PasskeyOptionsSerializer, PasskeySerializer
from accounts.single_sign_on import is_of_provider_alone, require_local_sign_in
from workspace.api.errors import ApiProblem
from workspace.api.permissions import EVERYBODY, InTheBrowserAlone
from workspace.api.signed_in import SignedInRequest


def check_passkey(request: SignedInRequest, response: Any) -> None:
    """Check the response of one of the user's passkeys to the challenge of this session. Raises ApiProblem 400."""
    try:
        confirm_with_passkey(user=request.user, credential=json.dumps(response))
    except PasskeyRefused as error:
        raise _refused() from error


def _require_passkeys(request: SignedInRequest) -> None:
    """Raise ApiProblem 403 for users whom only the identity provider signs in: a passkey would outlive their account there."""
    require_local_sign_in()
    if is_of_provider_alone(request.user):
        raise ApiProblem(403, "local_sign_in_off", _("Your account signs in at the identity provider alone, without passkeys."))


def _refused() -> ApiProblem:
    message = _("The passkey was not accepted. Try again.")
    return ApiProblem(400, "invalid", message, details={"passkey": [message]})


class AccountPasskeys(APIView):
    write_roles = EVERYBODY
    permission_classes = [InTheBrowserAlone]

    @extend_schema(operation_id="list_passkeys", summary="One's own passkeys, the oldest first", responses=PasskeyListSerializer)
    def get(self, request: SignedInRequest) -> Response:
        return Response({"results": PasskeySerializer(passkeys_of(request.user), many=True).data})

    @extend_schema(
        operation_id="add_passkey",
        summary="Add a passkey",
        description="After `POST /account/passkeys/options` in the same session. Not with a token.",
        request=PasskeyInputSerializer,
        responses={201: PasskeySerializer, 403: PASSWORD_NEEDED, 409: OpenApiResponse(description="There are too many.")},
    )
    def post(self, request: SignedInRequest) -> Response:
        _require_passkeys(request)
        require_reauthentication(request)
        body = PasskeyInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        values = body.validated_data
        try:
            added = add_passkey(request=request, user=request.user, name=values["name"], credential=values["passkey"])
        except PasskeyRefused as error:
            raise _refused() from error
        except TooManyPasskeys as error:
            message = _("You have {count} passkeys. Remove one that is not needed any more.").format(count=MAX_PASSKEYS)
            raise ApiProblem(409, "too_many_passkeys", message) from error
        return Response(PasskeySerializer(added).data, status=201)


class AccountPasskeyOptions(APIView):
    write_roles = EVERYBODY
    permission_classes = [InTheBrowserAlone]

    @extend_schema(
        operation_id="get_passkey_options",
        summary="Make a challenge for a new passkey",
        description="This session keeps it. Within 15 min of saying one's password. Not with a token.",
        request=None,
        responses={200: PasskeyOptionsSerializer, 403: PASSWORD_NEEDED},
    )
    def post(self, request: SignedInRequest) -> Response:
        _require_passkeys(request)
        require_reauthentication(request)
        return Response({"options": creation_options(request.user)})


class AccountPasskey(APIView):
    write_roles = EVERYBODY
    permission_classes = [InTheBrowserAlone]

    @extend_schema(
        operation_id="remove_passkey",
        summary="Remove one of one's own passkeys",
        responses={204: OpenApiResponse(description="Removed."), 403: PASSWORD_NEEDED},
    )
    def delete(self, request: SignedInRequest, passkey_id: int) -> Response:
        require_reauthentication(request)
        passkey = passkeys_of(request.user).filter(pk=passkey_id).first()
        if passkey is None:
            raise ApiProblem(404, "not_found", _("You have no such passkey."))
        remove_passkey(passkey=passkey, user=request.user)
        return Response(status=204)
