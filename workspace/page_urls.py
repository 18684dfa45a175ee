"""Addresses of the account's pages."""

from django.urls import path

from workspace.account_pages import (
    ChangePasswordPage,
    LostPasswordPage,
    LostPasswordSentPage,
    NewPasswordPage,
    NewPasswordSetPage,
    PasswordChangedPage,
)
from workspace.people_pages import AccountPage, AdministrationPage, InvitationPage
from workspace.sign_in_pages import SignInPage, SignOutPage

urlpatterns = [
    path("sign-in", SignInPage.as_view(), name="sign-in"),
    path("sign-out", SignOutPage.as_view(), name="sign-out"),
    path("account", AccountPage.as_view(), name="account"),
    path("administration", AdministrationPage.as_view(), name="administration"),
    path("invitation/<str:token>", InvitationPage.as_view(), name="invitation"),
    path("lost-password", LostPasswordPage.as_view(), name="lost-password"),
    path("lost-password/sent", LostPasswordSentPage.as_view(), name="lost-password-sent"),
    path("new-password/<uidb64>/<token>", NewPasswordPage.as_view(), name="new-password"),
    path("new-password/set", NewPasswordSetPage.as_view(), name="new-password-set"),
    path("change-password", ChangePasswordPage.as_view(), name="change-password"),
    path("change-password/done", PasswordChangedPage.as_view(), name="password-changed"),
]
