"""URLs of accounts under /api/v1/."""

from django.urls import path

from accounts.views import account, passkeys, service_accounts, sessions, users

urlpatterns = [
    path("account", account.Account.as_view(), name="api-account"),
    path("account/map-view", account.AccountMapView.as_view(), name="api-account-map-view"),
    path("account/password", account.AccountPassword.as_view(), name="api-account-password"),
    path("account/email-address/verification", account.AccountEmailAddress.as_view(), name="api-account-email-address"),
    path("account/passkeys", passkeys.AccountPasskeys.as_view(), name="api-account-passkeys"),
    path("account/passkeys/options", passkeys.AccountPasskeyOptions.as_view(), name="api-account-passkey-options"),
    path("account/passkeys/<int:passkey_id>", passkeys.AccountPasskey.as_view(), name="api-account-passkey"),
    path("account/sign-out-everywhere", sessions.AccountSessions.as_view(), name="api-account-sessions"),
    path("account/session", sessions.ThisSession.as_view(), name="api-account-this-session"),
    path("account/proof", sessions.Reauthentication.as_view(), name="api-account-proof"),
    path("account/sessions", sessions.AccountSessionList.as_view(), name="api-account-session-list"),
    path("account/sessions/<int:session_id>", sessions.AccountSession.as_view(), name="api-account-session"),
    path("account/tokens", account.AccountTokens.as_view(), name="api-account-tokens"),
    path("account/tokens/<int:token_id>", account.AccountToken.as_view(), name="api-account-token"),
    path("account/sign-ins", account.AccountSignIns.as_view(), name="api-account-sign-ins"),
    path("organisation", account.OwnOrganisation.as_view(), name="api-organisation"),
    path("users", users.UserList.as_view(), name="api-users"),
    path("users/<int:user_id>", users.UserDetail.as_view(), name="api-user"),
    path("users/<int:user_id>/sign-out", users.UserSessions.as_view(), name="api-user-sessions"),
    path("users/<int:user_id>/tokens", users.UserTokens.as_view(), name="api-user-tokens"),
    path("users/<int:user_id>/second-factor", users.UserSecondFactor.as_view(), name="api-user-second-factor"),
    path("service-accounts", service_accounts.ServiceAccountList.as_view(), name="api-service-accounts"),
    path("service-accounts/<int:account_id>", service_accounts.ServiceAccountDetail.as_view(), name="api-service-account"),
    path("service-accounts/<int:account_id>/tokens", service_accounts.ServiceAccountTokens.as_view(), name="api-service-account-tokens"),
    path(
        "service-accounts/<int:account_id>/tokens/<int:token_id>",
        service_accounts.ServiceAccountToken.as_view(),
        name="api-service-account-token",
    ),
    path("second-factor-rule", users.SecondFactorRule.as_view(), name="api-second-factor-rule"),
    path("invitations", users.InvitationList.as_view(), name="api-invitations"),
    path("invitations/<int:invitation_id>", users.InvitationDetail.as_view(), name="api-invitation"),
    path("sign-ins", users.SignInList.as_view(), name="api-sign-ins"),
]
