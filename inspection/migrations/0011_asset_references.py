"""Keeps an organisation's own ids and attributes of assets beside the shared map data."""

import django.db.models.deletion
import django.db.models.functions.datetime
from django.db import migrations, models
from django.db.models import Q


class Migration(migrations.Migration):
    dependencies = [("inspection", "0010_records_not_read"), ("workspace", "0009_token_scopes")]

    operations = [
        migrations.CreateModel(
            name="AssetReference",
            fields=[
                ("id", models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name="ID")),
                ("external_id", models.CharField(blank=True, db_default="", default="", max_length=200)),
                ("attributes", models.JSONField(blank=True, db_default={}, default=dict)),
                ("updated_at", models.DateTimeField(auto_now=True, db_default=django.db.models.functions.datetime.Now())),
                (
                    "asset",
                    models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name="references", to="inspection.asset"),
                ),
                (
                    "organisation",
                    models.ForeignKey(
                        on_delete=django.db.models.deletion.CASCADE, related_name="asset_references", to="workspace.organisation"
                    ),
                ),
            ],
            options={"ordering": ["pk"]},
        ),
        migrations.AddConstraint(
            "assetreference", models.UniqueConstraint(fields=["organisation", "asset"], name="asset_reference_one_each")
        ),
        migrations.AddConstraint(
            "assetreference",
            models.UniqueConstraint(fields=["organisation", "external_id"], condition=~Q(external_id=""), name="asset_external_id_unique"),
        ),
    ]
