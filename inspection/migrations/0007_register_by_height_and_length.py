"""Indexes of the register of assets: by height, and by length."""

from django.contrib.postgres.operations import AddIndexConcurrently
from django.db import migrations, models
from django.db.models import F, FloatField, Q, Value
from django.db.models.functions import Coalesce


class Migration(migrations.Migration):
    atomic = False

    dependencies = [("inspection", "0006_asset_register")]

    operations = [
        AddIndexConcurrently(
            model_name="asset",
            index=models.Index(
                Coalesce("height_m", Value(0.0), output_field=FloatField()),
                F("id"),
                condition=Q(vanished_at=None),
                name="asset_height_idx",
            ),
        ),
        AddIndexConcurrently(
            model_name="asset",
            index=models.Index(
                Coalesce("length_m", Value(0.0), output_field=FloatField()),
                F("id"),
                condition=Q(vanished_at=None),
                name="asset_length_idx",
            ),
        ),
    ]
