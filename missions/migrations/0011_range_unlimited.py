"""An unlimited range is chosen on purpose. UAVs without a type, range or battery stay incomplete until one is stated."""

from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("missions", "0010_failed_rehearsal_reason")]

    operations = [
        migrations.AddField(
            model_name="uavtype",
            name="range_unlimited",
            field=models.BooleanField(db_default=False, default=False, help_text="chosen on purpose: no range limits its UAVs"),
        ),
        migrations.AlterField(
            model_name="uavtype",
            name="max_range_m",
            field=models.FloatField(blank=True, help_text="metres on one battery", null=True),
        ),
        migrations.AlterField(
            model_name="uav",
            name="max_range_m",
            field=models.FloatField(blank=True, help_text="metres on one battery; empty = its type's", null=True),
        ),
        migrations.AlterField(
            model_name="uav",
            name="end_action",
            field=models.CharField(
                choices=[
                    ("hover", "Hover at the last target"),
                    ("return", "Return to start"),
                    ("land", "Land at the last target"),
                    ("base", "Land at the nearest base"),
                ],
                default="return",
                max_length=10,
            ),
        ),
    ]
