"""manage.py make_demo_missions: requests the demo missions; a worker makes them once the site is up."""

from typing import Any

from django.core.management.base import BaseCommand

from simulation.services.demo_missions import has_demo_region, want_demo_missions
from workspace.models import Organisation, Role, User


class Command(BaseCommand):
    help = "Ask for the demo region's missions: one flown, one in flight, one planned. A worker makes them."

    def handle(self, *args: Any, **options: Any) -> None:
        organisation = Organisation.objects.order_by("pk").first()
        actor = (
            User.objects.filter(organisation=organisation, role=Role.ADMINISTRATOR, is_active=True, is_service=False).order_by("pk").first()
        )
        if organisation is None or actor is None or not has_demo_region(organisation):
            self.stdout.write("No demo missions: there is no administrator, or the demo region is missing.")
            return
        job = want_demo_missions(organisation=organisation, actor=actor)
        self.stdout.write(f"Job {job.pk} makes them.")
