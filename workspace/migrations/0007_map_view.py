"""The view at which a user's maps open."""

from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("workspace", "0006_organisations_and_addresses")]

    operations = [
        migrations.AddField(
            model_name="user",
            name="map_view",
            field=models.JSONField(
                blank=True, editable=False, help_text="where maps open: zoom, longitude, latitude", null=True
            ),
        ),
    ]
