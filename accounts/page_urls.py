"""URLs of the account pages."""

from django.urls import path

from accounts.pages.password import (
    ChangePasswordPage,
    LostPasswordPage,
    LostPasswordSentPage,
    NewPasswordPage,
    NewPasswordSetPage,
    PasswordChangedPage,
)
from accounts.pages.second_factors import CodePage, NewCodesPage, RemovePage, SetUpPage
from accounts.pages.sign_in import PasskeySignIn, SignInPage, SignOutPage
from accounts.pages.single_sign_on import SingleSignOn, SingleSignOnCallback, SingleSignOnReauthentication
from accounts.pages.users import AccountPage, AdministrationPage, EmailAddressPage, InvitationPage
from workspace.pages import OfflinePage, service_worker

urlpatterns = [
    path("service-worker.js", service_worker, name="service-worker"),
    path("offline", OfflinePage.as_view(), name="offline"),
    path("sign-in", SignInPage.as_view(), name="account_login"),
    path("sign-in/passkey", PasskeySignIn.as_view(), name="sign-in-passkey"),
    path("sign-in/code", CodePage.as_view(), name="mfa_authenticate"),
    path("single-sign-on", SingleSignOn.as_view(), name="single-sign-on"),
    path("single-sign-on/callback", SingleSignOnCallback.as_view(), name="single-sign-on-callback"),
    path("single-sign-on/reauthentication", SingleSignOnReauthentication.as_view(), name="single-sign-on-reauthentication"),
    path("sign-out", SignOutPage.as_view(), name="sign-out"),
    path("account", AccountPage.as_view(), name="account"),
    path("email-address/<str:key>", EmailAddressPage.as_view(), name="account_confirm_email"),
    path("administration", AdministrationPage.as_view(), name="administration"),
    path("invitation/<str:token>", InvitationPage.as_view(), name="invitation"),
    path("second-factor", SetUpPage.as_view(), name="second-factor"),
    path("second-factor/codes", NewCodesPage.as_view(), name="second-factor-codes"),
    path("second-factor/remove", RemovePage.as_view(), name="second-factor-remove"),
    path("lost-password", LostPasswordPage.as_view(), name="lost-password"),
    path("lost-password/sent", LostPasswordSentPage.as_view(), name="lost-password-sent"),
    path("new-password/<uidb64>/<token>", NewPasswordPage.as_view(), name="new-password"),
    path("new-password/set", NewPasswordSetPage.as_view(), name="new-password-set"),
    path("change-password", ChangePasswordPage.as_view(), name="change-password"),
    path("change-password/done", PasswordChangedPage.as_view(), name="password-changed"),
]
