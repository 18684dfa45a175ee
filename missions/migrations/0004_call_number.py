"""The number before the letters of a mission's UAVs, while several missions fly."""

from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("missions", "0003_simulated_copies")]

    operations = [
        migrations.AddField(
            model_name="mission",
            name="call_number",
            field=models.PositiveSmallIntegerField(
                blank=True,
                help_text="before the letters of its UAVs while several missions fly: 2 of 2B; empty: never sent to UAVs",
                null=True,
            ),
        ),
    ]
