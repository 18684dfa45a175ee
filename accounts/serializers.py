"""API shapes of accounts, users, invitations and logins."""

from datetime import datetime
from ipaddress import ip_address
from typing import Any, ClassVar

from allauth.mfa.models import Authenticator
from django.conf import settings
from django.contrib.auth.password_validation import validate_password
from django.utils import timezone
from django.utils.translation import gettext as _
from drf_spectacular.utils import extend_schema_field

from accounts.invitations import MAX_DAYS, state_of
from accounts.invitations import InvitationState as State
from accounts.passkeys import MAX_NAME_LENGTH
from accounts.services import name_of, revision_of_user
from workspace.api import strict_serializers as serializers
from workspace.jobs.serializers import Declared
from workspace.models import (
    SCOPES_OF_ROLE,
    ApiToken,
    BrowserSession,
    Invitation,
    Organisation,
    Role,
    SignInEntry,
    SignInOutcome,
    Theme,
    TokenScope,
    Units,
    User,
)
from workspace.sessions.browser_sessions import session_ends_at
from workspace.sessions.preferences import TIME_ZONES

InvitationState = [state.value for state in State]
MAX_TOKEN_DAYS = 365


def known_time_zone(name: str) -> str:
    """Return the name of a zone, or empty. Raises ValidationError."""
    if name and name not in TIME_ZONES:
        raise serializers.ValidationError(_("There is no time zone of this name."))
    return name


class AccountSerializer(serializers.ModelSerializer):
    """The authenticated user and their preferences. Stored and sent values are always metric and UTC."""

    organisation = serializers.CharField(source="organisation.name", read_only=True)

    class Meta:
        model = User
        fields = [
            "id", "username", "first_name", "last_name", "email", "role", "organisation", "theme", "units", "time_zone", "language",
            "single_keys", "last_login",
        ]  # fmt: skip
        read_only_fields = ["id", "username", "email", "role", "organisation", "last_login"]


class AccountChangeSerializer(serializers.Serializer):
    """Fields to change."""

    first_name = serializers.CharField(max_length=150, allow_blank=True, required=False)
    last_name = serializers.CharField(max_length=150, allow_blank=True, required=False)
    theme = serializers.ChoiceField(choices=Theme.choices, required=False)
    units = serializers.ChoiceField(choices=Units.choices, required=False)
    time_zone = serializers.CharField(
        max_length=64, allow_blank=True, required=False, help_text="IANA name; empty: the organisation's, else the browser's"
    )
    language = serializers.CharField(max_length=10, allow_blank=True, required=False, help_text="code; empty: the browser's")
    single_keys = serializers.BooleanField(required=False)

    def validate_time_zone(self, value: str) -> str:
        return known_time_zone(value)

    def validate_language(self, value: str) -> str:
        if value and value not in dict(settings.LANGUAGES):
            raise serializers.ValidationError(_("The pages are not available in this language."))
        return value


class MapViewSerializer(serializers.Serializer):
    zoom = serializers.FloatField(min_value=0, max_value=24)
    longitude = serializers.FloatField(min_value=-180, max_value=180)
    latitude = serializers.FloatField(min_value=-90, max_value=90)


class PasswordChangeSerializer(serializers.Serializer):
    old_password = serializers.CharField(trim_whitespace=False, max_length=4_096)
    new_password = serializers.CharField(trim_whitespace=False, max_length=4_096)
    end_tokens = serializers.BooleanField(default=False, help_text="revoke all own tokens as well")

    def validate_new_password(self, value: str) -> str:
        validate_password(value, self.context["user"])
        return value


class TokenSerializer(serializers.ModelSerializer):
    """A bearer token, without the token itself."""

    is_valid: Declared = serializers.SerializerMethodField()
    scopes: Declared = serializers.SerializerMethodField()

    class Meta:
        model = ApiToken
        fields = ["id", "name", "scopes", "created_at", "expires_at", "revoked_at", "last_used_at", "is_valid"]
        read_only_fields = fields

    def get_scopes(self, token: ApiToken) -> list[TokenScope]:
        return [scope for scope in SCOPES_OF_ROLE[token.user.role] if token.scopes is None or scope in token.scopes]

    def get_is_valid(self, token: ApiToken) -> bool:
        return token.revoked_at is None and token.expires_at > timezone.now()


class NewTokenSerializer(TokenSerializer):
    """The only response that contains the token itself."""

    token = serializers.CharField(read_only=True, help_text="shown this once")

    class Meta(TokenSerializer.Meta):
        fields = [*TokenSerializer.Meta.fields, "token"]
        read_only_fields = fields


class TokenInputSerializer(serializers.Serializer):
    name = serializers.CharField(max_length=100)
    days = serializers.IntegerField(min_value=1, max_value=MAX_TOKEN_DAYS, default=90)
    scopes = serializers.ListField(
        child=serializers.ChoiceField(choices=TokenScope.choices), min_length=1, max_length=len(TokenScope), required=False,
        help_text="what it may be used for, within the role; all that the role has unless told",
    )  # fmt: skip

    def validate_scopes(self, scopes: list[str]) -> list[str]:
        own = SCOPES_OF_ROLE[self.context["user"].role]
        if beyond := sorted(set(scopes) - set(own)):
            raise serializers.ValidationError(_("The role does not have {scopes}.").format(scopes=", ".join(beyond)))
        return [scope for scope in own if scope in scopes]


class TokenListSerializer(serializers.Serializer):
    results = TokenSerializer(many=True)


class ReauthenticationSerializer(serializers.Serializer):
    """One of the two."""

    password = serializers.CharField(trim_whitespace=False, max_length=4_096, required=False)
    passkey = serializers.JSONField(required=False, help_text="the JSON form of the response to `passkey_options`")

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        if len(attrs) != 1:
            raise serializers.ValidationError(_("Send a password or a passkey’s response."))
        return attrs


class ReauthenticationAtProviderSerializer(serializers.Serializer):
    """A link to the identity provider, which comes back to `next`, a path of the query."""

    address = serializers.CharField()
    name = serializers.CharField(help_text="of the provider")


class ReauthenticationMethodsSerializer(serializers.Serializer):
    has_password = serializers.BooleanField()
    passkey_options: Declared = serializers.DictField(
        allow_null=True, help_text="for `navigator.credentials.get`; null for users without a passkey"
    )
    single_sign_on = ReauthenticationAtProviderSerializer(allow_null=True, help_text="null for users whom no provider signs in")


class PasskeySerializer(serializers.ModelSerializer):
    name = serializers.CharField(source="wrap.name")

    class Meta:
        model = Authenticator
        fields = ["id", "name", "created_at", "last_used_at"]
        read_only_fields = fields


class PasskeyListSerializer(serializers.Serializer):
    results = PasskeySerializer(many=True)


class PasskeyInputSerializer(serializers.Serializer):
    name = serializers.CharField(max_length=MAX_NAME_LENGTH)
    passkey = serializers.JSONField(help_text="the JSON form of the response to the options")


class PasskeyOptionsSerializer(serializers.Serializer):
    options: Declared = serializers.DictField(help_text="for `navigator.credentials.create`, in their JSON form")


class VerificationMailSerializer(serializers.Serializer):
    was_mailed = serializers.BooleanField()


class SessionTimesSerializer(serializers.Serializer):
    ends_at = serializers.DateTimeField()
    ends_in_s = serializers.IntegerField()


class BrowserSessionSerializer(serializers.ModelSerializer):
    """A session in a browser, without its key."""

    ends_at = serializers.SerializerMethodField()
    is_this_one = serializers.SerializerMethodField(help_text="the one that asks")
    place = serializers.SerializerMethodField(help_text="where the address lies; null: unknown")

    class Meta:
        model = BrowserSession
        fields = ["id", "user_agent", "address", "place", "began_at", "present_at", "ends_at", "is_this_one"]
        read_only_fields = fields

    def get_ends_at(self, session: BrowserSession) -> datetime:
        return session_ends_at(session)

    @extend_schema_field(serializers.ChoiceField(choices=["this-machine", "private-network", "internet"], allow_null=True))
    def get_place(self, session: BrowserSession) -> str | None:
        if session.address is None:
            return None
        address = ip_address(session.address)
        return "this-machine" if address.is_loopback else "private-network" if address.is_private else "internet"

    def get_is_this_one(self, session: BrowserSession) -> bool:
        return bool(session.pk == self.context.get("own"))


class BrowserSessionListSerializer(serializers.Serializer):
    results = BrowserSessionSerializer(many=True)


class SecondFactorRuleSerializer(serializers.Serializer):
    required: Declared = serializers.BooleanField(help_text="of everybody in the organisation, from their next sign-in on")
    is_of_the_installation = serializers.BooleanField(read_only=True, help_text="required whatever the organisation says")


class OrganisationSerializer(serializers.ModelSerializer):
    """One's organisation."""

    class Meta:
        model = Organisation
        fields = ["name", "time_zone", "revision"]
        read_only_fields = ["revision"]
        extra_kwargs: ClassVar[dict[str, Any]] = {"name": {"required": False}, "time_zone": {"required": False}}

    def validate_time_zone(self, value: str) -> str:
        return known_time_zone(value)


class UserSerializer(serializers.ModelSerializer):
    """An account as administrators see it."""

    revision = serializers.SerializerMethodField(help_text="for If-Match")
    valid_tokens = serializers.IntegerField(read_only=True)
    has_second_factor = serializers.BooleanField(read_only=True)

    class Meta:
        model = User
        fields = [
            "id", "username", "first_name", "last_name", "email", "role", "is_active", "date_joined", "last_login", "last_seen_at",
            "valid_tokens", "has_second_factor", "revision",
        ]  # fmt: skip
        read_only_fields = fields

    def get_revision(self, user: User) -> int:
        return revision_of_user(user)


class UserChangeSerializer(serializers.Serializer):
    """Fields to change."""

    first_name = serializers.CharField(max_length=150, allow_blank=True, required=False)
    last_name = serializers.CharField(max_length=150, allow_blank=True, required=False)
    email = serializers.EmailField(allow_blank=True, required=False)
    role = serializers.ChoiceField(choices=Role.choices, required=False)
    is_active = serializers.BooleanField(required=False, help_text="whether they may sign in")


class UserPageSerializer(serializers.Serializer):
    results = UserSerializer(many=True)
    next = serializers.CharField(allow_null=True, help_text="address of the next page")


class ServiceAccountSerializer(serializers.ModelSerializer):
    """An account for a program."""

    name = serializers.SerializerMethodField()
    created_at = serializers.DateTimeField(source="date_joined")
    last_used_at = serializers.DateTimeField(read_only=True, allow_null=True, help_text="any of its tokens; to the minute")
    valid_tokens = serializers.IntegerField(read_only=True)
    revision = serializers.SerializerMethodField(help_text="for If-Match")

    class Meta:
        model = User
        fields = ["id", "name", "username", "role", "is_active", "created_at", "last_used_at", "valid_tokens", "revision"]
        read_only_fields = fields
        extra_kwargs: ClassVar = {"username": {"help_text": "by which the history names it"}}

    def get_name(self, account: User) -> str:
        return name_of(account)

    def get_revision(self, account: User) -> int:
        return revision_of_user(account)


class ServiceAccountInputSerializer(serializers.Serializer):
    name = serializers.RegexField(
        r"^[A-Za-z0-9][A-Za-z0-9._-]*\Z", max_length=60, help_text="letters, digits, dots, hyphens and underscores"
    )
    role = serializers.ChoiceField(choices=Role.choices)


class ServiceAccountChangeSerializer(serializers.Serializer):
    """Fields to change."""

    role = serializers.ChoiceField(choices=Role.choices, required=False)
    is_active = serializers.BooleanField(required=False, help_text="false: none of its tokens works")


class ServiceAccountPageSerializer(serializers.Serializer):
    results = ServiceAccountSerializer(many=True)
    next = serializers.CharField(allow_null=True, help_text="address of the next page")


class InvitationSerializer(serializers.ModelSerializer):
    """An invitation, without the link itself."""

    state = serializers.SerializerMethodField()
    invited_by = serializers.SerializerMethodField()
    accepted_by = serializers.SerializerMethodField()

    class Meta:
        model = Invitation
        fields = ["id", "email", "role", "state", "invited_by", "created_at", "expires_at", "revoked_at", "accepted_at", "accepted_by"]
        read_only_fields = fields

    def get_state(self, invitation: Invitation) -> str:
        return state_of(invitation).value

    def get_invited_by(self, invitation: Invitation) -> str | None:
        return invitation.invited_by.username if invitation.invited_by else None

    def get_accepted_by(self, invitation: Invitation) -> str | None:
        return invitation.accepted_by.username if invitation.accepted_by else None


class NewInvitationSerializer(InvitationSerializer):
    """The only response that contains the link itself."""

    link = serializers.CharField(read_only=True, help_text="shown this once")
    was_mailed = serializers.BooleanField(read_only=True)

    class Meta(InvitationSerializer.Meta):
        fields = [*InvitationSerializer.Meta.fields, "link", "was_mailed"]
        read_only_fields = fields


class InvitationInputSerializer(serializers.Serializer):
    role = serializers.ChoiceField(choices=Role.choices)
    email = serializers.EmailField(allow_blank=True, default="", help_text="where the link is sent, if mail leaves here")
    days = serializers.IntegerField(min_value=1, max_value=MAX_DAYS, default=7)


class InvitationPageSerializer(serializers.Serializer):
    results = InvitationSerializer(many=True)
    next = serializers.CharField(allow_null=True, help_text="address of the next page")


class SignInSerializer(serializers.ModelSerializer):
    """A login attempt or a logout. `username` is null where the typed name is unknown."""

    username = serializers.SerializerMethodField()
    outcome = serializers.ChoiceField(choices=SignInOutcome.choices)

    class Meta:
        model = SignInEntry
        fields = ["id", "recorded_at", "outcome", "username", "address", "user_agent"]
        read_only_fields = fields

    def get_username(self, entry: SignInEntry) -> str | None:
        return entry.user.username if entry.user else None


class SignInPageSerializer(serializers.Serializer):
    results = SignInSerializer(many=True)
    next = serializers.CharField(allow_null=True, help_text="address of the next page")


def with_secret(shape: type[serializers.ModelSerializer], row: Any, **secret: Any) -> dict[str, Any]:
    """Return a row with values that are shown once."""
    for name, value in secret.items():
        setattr(row, name, value)
    return dict(shape(row).data)
