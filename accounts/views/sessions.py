"""API endpoints of the own browser sessions, and of when the current one ends."""

from django.contrib.auth import update_session_auth_hash
from django.urls import reverse
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from accounts import services
from accounts.identity_provider import identity_provider
from accounts.login import LOCAL_SIGN_IN_OFF, PASSWORD_NEEDED, note_reauthentication, require_reauthentication
from accounts.passkeys import request_options
from accounts.second_factors import passkeys_of
from accounts.serializers import (
    BrowserSessionListSerializer,
    BrowserSessionSerializer,
    ReauthenticationMethodsSerializer,
    ReauthenticationSerializer,
    SessionTimesSerializer,
)
from accounts.single_sign_on import identity_of, local_sign_in_is_on, require_local_sign_in
from accounts.views.account import check_password
from accounts.views.passkeys import check_passkey
from workspace.api.errors import ApiProblem
from workspace.api.permissions import EVERYBODY, InTheBrowserAlone
from workspace.api.signed_in import SignedInRequest
from workspace.models import BrowserSession
from workspace.sessions.browser_sessions import end_session, open_sessions, seconds_left, session_ends_at


class ThisSession(APIView):
    """GET does not count as presence; POST does."""

    write_roles = EVERYBODY
    permission_classes = [InTheBrowserAlone]

    @extend_schema(
        operation_id="get_session",
        summary="Until when the session that asks lasts",
        description="404 with a token. Asking does not make it longer.",
        responses=SessionTimesSerializer,
    )
    def get(self, request: Request) -> Response:
        return self._answer(request)

    @extend_schema(
        operation_id="keep_session",
        summary="Extend session",
        description="The session is not idle any more; it still ends a fixed time after signing in.",
        request=None,
        responses=SessionTimesSerializer,
    )
    def post(self, request: Request) -> Response:
        return self._answer(request)

    @staticmethod
    def _answer(request: Request) -> Response:
        row = None if request.auth is not None else _row_of(request)
        if row is None:
            raise ApiProblem(404, "not_found", _("There is no session."))
        return Response({"ends_at": session_ends_at(row), "ends_in_s": seconds_left(request.session)})


class Reauthentication(APIView):
    write_roles = EVERYBODY
    permission_classes = [InTheBrowserAlone]

    @extend_schema(
        operation_id="get_reauthentication_methods",
        summary="How to re-authenticate",
        description="Makes a challenge for passkeys, which this session keeps. Not with a token.",
        responses=ReauthenticationMethodsSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        if request.auth is not None:
            raise ApiProblem(404, "not_found", _("There is no session."))
        user, is_local = request.user, local_sign_in_is_on()
        provider = identity_provider() if identity_of(user) else None
        at_provider = provider and {"address": reverse("single-sign-on-reauthentication"), "name": provider.name}
        return Response(
            {
                "has_password": user.has_local_password,
                "passkey_options": request_options(user) if is_local and passkeys_of(user).exists() else None,
                "single_sign_on": at_provider,
            }
        )

    @extend_schema(
        operation_id="prove_oneself",
        summary="Re-authenticate",
        description="For 15 min this session may then make tokens and passkeys, and end sessions."
        " Five passwords may be tried in a quarter of an hour.",
        request=ReauthenticationSerializer,
        responses={204: OpenApiResponse(description="It is the password, or one of the user’s passkeys."), 403: LOCAL_SIGN_IN_OFF},
    )
    def post(self, request: SignedInRequest) -> Response:
        require_local_sign_in()
        body = ReauthenticationSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        if "passkey" in body.validated_data:
            check_passkey(request, body.validated_data["passkey"])
        else:
            check_password(request, "password", body.validated_data["password"])
        note_reauthentication(request.session)
        return Response(status=204)


class AccountSessionList(APIView):
    write_roles = EVERYBODY

    @extend_schema(
        operation_id="list_sessions",
        summary="One's own sessions in browsers that have not ended, the last used first",
        responses=BrowserSessionListSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        own = None if request.auth is not None else _row_of(request)
        shape = BrowserSessionSerializer(open_sessions(request.user), many=True, context={"own": own and own.pk})
        return Response({"results": shape.data})


class AccountSession(APIView):
    write_roles = EVERYBODY
    permission_classes = [InTheBrowserAlone]

    @extend_schema(
        operation_id="end_session",
        summary="End one of one's own sessions",
        description="Its open pages are told within 5 s. Not with a token.",
        responses={204: OpenApiResponse(description="Ended."), 403: PASSWORD_NEEDED},
    )
    def delete(self, request: SignedInRequest, session_id: int) -> Response:
        require_reauthentication(request)
        row = request.user.browser_sessions.filter(pk=session_id).first()
        if row is None:
            raise ApiProblem(404, "not_found", _("You have no such session."))
        end_session(row, actor=request.user)
        return Response(status=204)


class AccountSessions(APIView):
    write_roles = EVERYBODY
    permission_classes = [InTheBrowserAlone]

    @extend_schema(
        operation_id="sign_out_everywhere",
        summary="End one's own sessions in all other browsers",
        description="The session that asks stays. Tokens stay, too. Not with a token.",
        request=None,
        responses={204: OpenApiResponse(description="Ended."), 403: PASSWORD_NEEDED},
    )
    def post(self, request: SignedInRequest) -> Response:
        require_reauthentication(request)
        services.end_sessions(user=request.user, actor=request.user)
        update_session_auth_hash(request, request.user)
        return Response(status=204)


def _row_of(request: Request) -> BrowserSession | None:
    row: BrowserSession | None = getattr(request.session, "in_use", None)
    return row
