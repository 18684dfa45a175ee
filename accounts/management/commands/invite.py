"""Makes a link for the first account of an organisation: manage.py invite ORGANISATION [--role administrator] [--days 7]."""

from argparse import ArgumentParser
from typing import Any

from django.core.management.base import BaseCommand, CommandError
from django.urls import reverse

from accounts.invitations import MAX_DAYS, invite
from workspace.models import Organisation, Role


class Command(BaseCommand):
    help = "Invite somebody into an organisation, also one that has no administrator yet. The last line is the link's path; it works once."

    def add_arguments(self, parser: ArgumentParser) -> None:
        parser.add_argument("organisation", help="its name")
        parser.add_argument("--role", choices=Role.values, default=Role.ADMINISTRATOR.value)
        parser.add_argument("--days", type=int, default=7, help="how long the link works (7)")

    def handle(self, *args: Any, **options: Any) -> None:
        organisation = Organisation.objects.filter(name=options["organisation"]).first()
        if organisation is None:
            raise CommandError(f"no organisation is called {options['organisation']}")
        if not 1 <= options["days"] <= MAX_DAYS:
            raise CommandError(f"--days: 1 to {MAX_DAYS}")
        invitation, token = invite(organisation=organisation, actor=None, role=Role(options["role"]), email="", days=options["days"])
        self.stdout.write(f"For {invitation.get_role_display()} of {organisation}, until {invitation.expires_at:%Y-%m-%d %H:%M} UTC:")
        self.stdout.write(reverse("invitation", args=[token]))
