"""The languages of users are those of locale/: no choices in the column."""

from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("workspace", "0003_codes_of_fixed_messages")]

    operations = [
        migrations.AlterField(
            model_name="user",
            name="language",
            field=models.CharField(blank=True, default="", help_text="code; empty: the browser's", max_length=10),
        ),
    ]
