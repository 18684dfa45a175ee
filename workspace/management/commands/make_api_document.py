"""Makes the OpenAPI document of this version and stores it beside the static files: manage.py make_api_document."""

from typing import Any

from django.core.management.base import BaseCommand

from workspace.api.api_document import FORMS, stored


class Command(BaseCommand):
    help = "Make the OpenAPI document, unless that of this version is kept already."

    def handle(self, *args: Any, **options: Any) -> None:
        for form in FORMS:
            stored(form)
