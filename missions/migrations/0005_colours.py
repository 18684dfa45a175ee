"""The colours of a mission's UAVs, which no others have while they fly."""

import django.contrib.postgres.fields
from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("missions", "0004_call_number")]

    operations = [
        migrations.AddField(
            model_name="mission",
            name="colours",
            field=django.contrib.postgres.fields.ArrayField(
                base_field=models.PositiveSmallIntegerField(),
                blank=True,
                db_default=[],
                default=list,
                help_text="numbers of the colours of its UAVs by their places; empty: never sent to UAVs, those of the places",
                size=None,
            ),
        ),
    ]
