"""Why a mission was approved without a passed rehearsal."""

from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("missions", "0009_codes_of_fixed_texts")]

    operations = [
        migrations.AddField(
            model_name="approval",
            name="failed_rehearsal_reason",
            field=models.CharField(
                blank=True,
                db_default="",
                default="",
                help_text="why it was approved without a passed rehearsal",
                max_length=300,
            ),
        ),
    ]
