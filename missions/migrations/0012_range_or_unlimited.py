"""A type has a range or none on purpose, and not both; a stated range counts where rows have both."""

from django.db import migrations, models
from django.db.models import Q


def keep_stated_ranges(apps, schema_editor):
    apps.get_model("missions", "UavType").objects.filter(range_unlimited=True, max_range_m__isnull=False).update(range_unlimited=False)


class Migration(migrations.Migration):
    dependencies = [("missions", "0011_range_unlimited")]

    operations = [
        migrations.RunPython(keep_stated_ranges, migrations.RunPython.noop),
        migrations.AddConstraint(
            model_name="uavtype",
            constraint=models.CheckConstraint(condition=Q(range_unlimited=False) | Q(max_range_m=None), name="uav_type_range_or_unlimited"),
        ),
    ]
