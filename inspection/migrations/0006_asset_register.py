"""Indexes of the register of assets: by name, and by the last change."""

from django.contrib.postgres.operations import AddIndexConcurrently
from django.db import migrations, models
from django.db.models import F, Q, Value
from django.db.models.functions import Coalesce, NullIf, Upper


class Migration(migrations.Migration):
    atomic = False

    dependencies = [("inspection", "0005_regions")]

    operations = [
        AddIndexConcurrently(
            model_name="asset",
            index=models.Index(
                Coalesce(NullIf(Upper("ref"), Value("")), NullIf(Upper("name"), Value("")), Value("\U0010ffff")),
                F("id"),
                condition=Q(vanished_at=None),
                name="asset_register_idx",
            ),
        ),
        AddIndexConcurrently(
            model_name="asset",
            index=models.Index(fields=["updated_at", "id"], name="asset_updated_idx"),
        ),
    ]
