"""Room on the page for the next version of a row that changes several times a second.

A row of a watch fills a quarter of a page: without room each change went to another page, and after three minutes of 200 UAVs their 200
rows lay in 57 MB, which every look of a live page read.
"""

from django.db import migrations


class Migration(migrations.Migration):
    dependencies = [("telemetry", "0012_doubt_of_a_new_link")]
    operations = [
        migrations.RunSQL(
            "ALTER TABLE telemetry_uavwatch"
            " SET (fillfactor = 25, autovacuum_vacuum_scale_factor = 0, autovacuum_vacuum_threshold = 2000)",
            "ALTER TABLE telemetry_uavwatch RESET (fillfactor, autovacuum_vacuum_scale_factor, autovacuum_vacuum_threshold)",
        )
    ]
