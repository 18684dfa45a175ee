"""Addresses of accounts under /api/v1/."""

from django.urls import path

from accounts import account_views, service_account_views, session_views, user_views

urlpatterns = [
    path("account", account_views.Account.as_view(), name="api-account"),
    path("account/password", account_views.AccountPassword.as_view(), name="api-account-password"),
    path("account/sign-out-everywhere", session_views.AccountSessions.as_view(), name="api-account-sessions"),
    path("account/session", session_views.ThisSession.as_view(), name="api-account-this-session"),
    path("account/proof", session_views.Proof.as_view(), name="api-account-proof"),
    path("account/sessions", session_views.AccountSessionList.as_view(), name="api-account-session-list"),
    path("account/sessions/<int:session_id>", session_views.AccountSession.as_view(), name="api-account-session"),
    path("account/tokens", account_views.AccountTokens.as_view(), name="api-account-tokens"),
    path("account/tokens/<int:token_id>", account_views.AccountToken.as_view(), name="api-account-token"),
    path("account/sign-ins", account_views.AccountSignIns.as_view(), name="api-account-sign-ins"),
    path("people", user_views.PersonList.as_view(), name="api-people"),
    path("people/<int:user_id>", user_views.PersonDetail.as_view(), name="api-person"),
    path("people/<int:user_id>/sign-out", user_views.PersonSessions.as_view(), name="api-person-sessions"),
    path("people/<int:user_id>/tokens", user_views.PersonTokens.as_view(), name="api-person-tokens"),
    path("people/<int:user_id>/second-factor", user_views.PersonSecondFactor.as_view(), name="api-person-second-factor"),
    path("service-accounts", service_account_views.ServiceAccountList.as_view(), name="api-service-accounts"),
    path("service-accounts/<int:account_id>", service_account_views.ServiceAccountDetail.as_view(), name="api-service-account"),
    path(
        "service-accounts/<int:account_id>/tokens", service_account_views.ServiceAccountTokens.as_view(), name="api-service-account-tokens"
    ),
    path(
        "service-accounts/<int:account_id>/tokens/<int:token_id>",
        service_account_views.ServiceAccountToken.as_view(),
        name="api-service-account-token",
    ),
    path("second-factor-rule", user_views.SecondFactorRule.as_view(), name="api-second-factor-rule"),
    path("invitations", user_views.InvitationList.as_view(), name="api-invitations"),
    path("invitations/<int:invitation_id>", user_views.InvitationDetail.as_view(), name="api-invitation"),
    path("sign-ins", user_views.SignInList.as_view(), name="api-sign-ins"),
]
