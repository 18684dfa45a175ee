"""A key of each proposed change, by which it can be left out."""

from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("inspection", "0003_data_issues")]

    operations = [
        migrations.AddField(
            model_name="proposedchange",
            name="key",
            field=models.CharField(
                blank=True, db_default="", default="", help_text="names the row, to leave it out", max_length=300
            ),
        ),
    ]
