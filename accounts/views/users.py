"""API endpoints for administrators: users of the organisation, invitations, the sign-in log."""

from datetime import timedelta
from typing import Any

from django.conf import settings
from django.db.models import Count, Q, QuerySet
from django.http import Http404
from django.urls import reverse
from django.utils import timezone
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from accounts import invitations, second_factors, services
from accounts.invitations import InvitationState, public_address
from accounts.login import LOCAL_SIGN_IN_OFF
from accounts.serializers import (
    InvitationInputSerializer,
    InvitationPageSerializer,
    InvitationSerializer,
    NewInvitationSerializer,
    SecondFactorRuleSerializer,
    SignInPageSerializer,
    SignInSerializer,
    UserChangeSerializer,
    UserPageSerializer,
    UserSerializer,
    with_secret,
)
from accounts.single_sign_on import require_local_sign_in
from accounts.users import NoAdministratorLeft, OperatorsAlone
from workspace.api.errors import ApiProblem
from workspace.api.paging import asked_choice, page_of
from workspace.api.permissions import ADMINISTRATORS, AdministratorsAlone, AdministratorsInTheBrowser, InTheBrowserAlone, may_change
from workspace.api.preconditions import IF_MATCH_REQUIRED, PRECONDITION_ANSWERS, etag_of, expected_revision
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest
from workspace.api.whole_numbers import WholeNumber
from workspace.models import Invitation, Role, SignInEntry, SignInOutcome, User

HERE_WITHIN = timedelta(minutes=5)
DAYS = WholeNumber("days", "only the last so many days", maximum=99_999)


def _users(request: SignedInRequest) -> QuerySet[User]:
    valid = Q(api_tokens__revoked_at=None, api_tokens__expires_at__gt=timezone.now())
    own = User.objects.filter(organisation_id=request.user.organisation_id, is_service=False)
    return second_factors.with_second_factor(own).annotate(valid_tokens=Count("api_tokens", filter=valid))


def _user_of_id(request: SignedInRequest, user_id: int) -> User:
    try:
        return _users(request).get(pk=user_id)
    except User.DoesNotExist as error:
        raise Http404 from error


def _named(text: str, before: str = "") -> Q:
    """Return a filter: each word must be in the name or the address."""
    wanted = Q()
    for word in text.split():
        names = ("username", "first_name", "last_name", "email")
        found = Q()
        for name in names:
            found |= Q(**{f"{before}{name}__icontains": word})
        wanted &= found
    return wanted


class UserList(APIView):
    permission_classes = [AdministratorsAlone]

    @extend_schema(
        operation_id="list_users",
        summary="Users of one's organisation by user name",
        parameters=[
            OpenApiParameter("text", str, description="words of the user name, the name or the e-mail address"),
            OpenApiParameter("role", str, enum=Role.values),
            OpenApiParameter("access", str, enum=["in", "out", "here"], description="may sign in; is kept out; was here in the last 5 min"),
            *PAGE_PARAMETERS,
        ],
        responses=UserPageSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        users = _users(request).filter(_named(request.query_params.get("text", "")[:200]))
        if role := asked_choice(request, "role", Role.values):
            users = users.filter(role=role)
        if access := asked_choice(request, "access", ["in", "out", "here"]):
            wanted: dict[str, dict[str, Any]] = {
                "in": {"is_active": True},
                "out": {"is_active": False},
                "here": {"is_active": True, "last_seen_at__gt": timezone.now() - HERE_WITHIN},
            }
            users = users.filter(**wanted[access])
        page = page_of(request, users, order=("username",))
        return Response({"results": UserSerializer(page.rows, many=True).data, "next": page.next})


class UserDetail(APIView):
    permission_classes = [AdministratorsInTheBrowser]

    @extend_schema(operation_id="get_user", summary="One user", responses=UserSerializer)
    def get(self, request: SignedInRequest, user_id: int) -> Response:
        return self._answer(request, user_id)

    @extend_schema(
        operation_id="change_user",
        summary="Change somebody's name, address, role or access",
        description="One administrator who can sign in is always left.",
        parameters=[IF_MATCH_REQUIRED],
        request=UserChangeSerializer,
        responses={200: UserSerializer, 409: OpenApiResponse(description="No administrator would be left."), **PRECONDITION_ANSWERS},
    )
    def patch(self, request: SignedInRequest, user_id: int) -> Response:
        body = UserChangeSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        _user_of_id(request, user_id)
        try:
            services.change_user(user_id=user_id, actor=request.user, seen_revision=expected_revision(request), **body.validated_data)
        except services.ChangedMeanwhile as error:
            current = UserSerializer(_user_of_id(request, user_id)).data
            words = _("Somebody else has changed {name} in the meantime. Look again.").format(name=error.person.username)
            raise ApiProblem(412, "changed", words, details={"current": current}) from error
        except NoAdministratorLeft as error:
            raise ApiProblem(409, "no_administrator_left", str(error)) from error
        except OperatorsAlone as error:
            raise ApiProblem(403, "operators_alone", str(error)) from error
        return self._answer(request, user_id)

    @staticmethod
    def _answer(request: SignedInRequest, user_id: int) -> Response:
        person = _user_of_id(request, user_id)
        return Response(UserSerializer(person).data, headers=etag_of(services.revision_of_user(person)))


class UserSessions(APIView):
    permission_classes = [AdministratorsInTheBrowser]

    @extend_schema(
        operation_id="sign_user_out",
        summary="End all sessions of somebody",
        description="Their tokens stay. Not with a token.",
        request=None,
        responses={204: OpenApiResponse(description="Ended.")},
    )
    def post(self, request: SignedInRequest, user_id: int) -> Response:
        services.end_sessions(user=_user_of_id(request, user_id), actor=request.user)
        return Response(status=204)


class UserTokens(APIView):
    permission_classes = [AdministratorsInTheBrowser]

    @extend_schema(
        operation_id="revoke_tokens_of_user",
        summary="Revoke all tokens of somebody",
        responses={204: OpenApiResponse(description="Revoked.")},
    )
    def delete(self, request: SignedInRequest, user_id: int) -> Response:
        services.revoke_tokens(user=_user_of_id(request, user_id), actor=request.user)
        return Response(status=204)


class UserSecondFactor(APIView):
    permission_classes = [AdministratorsInTheBrowser]

    @extend_schema(
        operation_id="reset_second_factor_of_user",
        summary="Take the second factor away from somebody who has lost it",
        description="Their sessions end. Where the organisation asks for one, their next sign-in sets another one up. Not with a token.",
        responses={204: OpenApiResponse(description="There is none any more.")},
    )
    def delete(self, request: SignedInRequest, user_id: int) -> Response:
        person = _user_of_id(request, user_id)
        if person.pk == request.user.pk:
            raise ApiProblem(409, "own_second_factor", _("Your own is on the page of your account, where a code is asked for."))
        if not may_change(request.user, person):
            raise ApiProblem(403, "operators_alone", str(OperatorsAlone()))
        second_factors.reset_second_factors(user=person, actor=request.user)
        return Response(status=204)


class SecondFactorRule(APIView):
    write_roles = ADMINISTRATORS
    permission_classes = [InTheBrowserAlone]

    @extend_schema(
        operation_id="get_second_factor_rule",
        summary="Whether everybody of one's organisation signs in with a second factor",
        responses=SecondFactorRuleSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        return self._answer(request)

    @extend_schema(
        operation_id="set_second_factor_rule",
        summary="Say whether everybody signs in with a second factor",
        description="Who has none sets one up at the next sign-in. Administrators alone, with one of their own. Not with a token.",
        request=SecondFactorRuleSerializer,
        responses={200: SecondFactorRuleSerializer, 409: OpenApiResponse(description="The administrator has none.")},
    )
    def put(self, request: SignedInRequest) -> Response:
        body = SecondFactorRuleSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        try:
            second_factors.require_second_factor(actor=request.user, required=body.validated_data["required"])
        except second_factors.SetUpFirst as error:
            raise ApiProblem(409, "set_up_first", _("Set up a second factor for yourself first, under Account.")) from error
        request.user.organisation.refresh_from_db(fields=["requires_second_factor"])
        return self._answer(request)

    @staticmethod
    def _answer(request: SignedInRequest) -> Response:
        required = second_factors.is_required_of(request.user)
        return Response({"required": required, "is_of_the_installation": settings.REQUIRES_SECOND_FACTOR})


class InvitationList(APIView):
    """The response with a link is not stored, so a repeated request makes another link."""

    permission_classes = [AdministratorsInTheBrowser]

    @extend_schema(
        operation_id="list_invitations",
        summary="Invitations, newest first",
        parameters=[OpenApiParameter("state", str, enum=[state.value for state in InvitationState]), *PAGE_PARAMETERS],
        responses=InvitationPageSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        rows = invitations.invitations_of(request.user).select_related("invited_by", "accepted_by")
        if state := asked_choice(request, "state", [state.value for state in InvitationState]):
            rows = rows.filter(invitations.in_state(InvitationState(state)))
        page = page_of(request, rows, order=("-created_at", "-pk"))
        return Response({"results": InvitationSerializer(page.rows, many=True).data, "next": page.next})

    @extend_schema(
        operation_id="invite",
        summary="Make a link for a new account; only this answer shows it",
        description="A repeated request makes another link.",
        request=InvitationInputSerializer,
        responses={201: NewInvitationSerializer, 403: LOCAL_SIGN_IN_OFF},
    )
    def post(self, request: SignedInRequest) -> Response:
        require_local_sign_in()
        body = InvitationInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        invitation, token = invitations.invite(organisation=request.user.organisation, actor=request.user, **body.validated_data)
        link = public_address(request) + reverse("invitation", args=[token])
        was_mailed = invitations.send_invitation(invitation=invitation, link=link)
        return Response(with_secret(NewInvitationSerializer, invitation, link=link, was_mailed=was_mailed), status=201)


class InvitationDetail(APIView):
    permission_classes = [AdministratorsInTheBrowser]

    @extend_schema(
        operation_id="revoke_invitation", summary="Make an invitation's link stop working", responses={200: InvitationSerializer}
    )
    def delete(self, request: SignedInRequest, invitation_id: int) -> Response:
        try:
            invitation = invitations.invitations_of(request.user).get(pk=invitation_id)
        except Invitation.DoesNotExist as error:
            raise Http404 from error
        return Response(InvitationSerializer(invitations.revoke_invitation(invitation=invitation, actor=request.user)).data)


class SignInList(APIView):
    permission_classes = [AdministratorsAlone]

    @extend_schema(
        operation_id="list_sign_ins",
        summary="Sign-ins, tries and sign-outs, newest first",
        description="Those of one's organisation, and tries with names that nobody has.",
        parameters=[
            OpenApiParameter("text", str, description="words of the person's name or e-mail address"),
            OpenApiParameter("outcome", str, enum=SignInOutcome.values),
            OpenApiParameter("address", str, description="beginning of the IP address"),
            DAYS.documented,
            *PAGE_PARAMETERS,
        ],
        responses=SignInPageSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        entries = SignInEntry.objects.filter(Q(user__organisation_id=request.user.organisation_id) | Q(user=None)).select_related("user")
        if text := request.query_params.get("text", "")[:200].strip():
            entries = entries.filter(_named(text, "user__"))
        if outcome := asked_choice(request, "outcome", SignInOutcome.values):
            entries = entries.filter(outcome=outcome)
        if address := request.query_params.get("address", "")[:45].strip():
            entries = entries.filter(address__istartswith=address)
        if days := DAYS.asked(request):
            entries = entries.filter(recorded_at__gt=timezone.now() - timedelta(days=days))
        page = page_of(request, entries, order=("-recorded_at", "-pk"))
        return Response({"results": SignInSerializer(page.rows, many=True).data, "next": page.next})
