"""Pages of one's own account, and of the administration of everybody's."""

from django.contrib.auth.mixins import UserPassesTestMixin

from workspace.pages import SignedInPage


class AccountPage(SignedInPage):
    template_name = "account.html"


class AdministrationPage(UserPassesTestMixin, SignedInPage):
    """People, invitations and the sign-in log: for administrators."""

    template_name = "administration.html"

    def test_func(self) -> bool:
        return bool(self.request.user.is_authenticated and self.request.user.is_superuser)
