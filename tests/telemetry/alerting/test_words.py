"""Whatever a detector or a service may say is known to the catalogues."""

from telemetry.alerting import advice
from telemetry.alerting.detectors import DETECTORS
from telemetry.selectors.alert_words import ADVICES, TEMPLATES
from telemetry.services.alerts import alerts, command_alerts
from telemetry.services.links import uav_outbox


def test_every_template_is_named_for_the_catalogues():
    modules = [
        *(detector.detect.__globals__ for detector in DETECTORS),
        *(vars(module) for module in (alerts, command_alerts, uav_outbox)),
    ]
    status_texts = {value for names in modules for value in names.values() if isinstance(value, str) and "%(uav)s" in value}
    assert status_texts == set(TEMPLATES)


def test_every_advice_is_named_for_the_catalogues():
    status_texts = {value for name, value in vars(advice).items() if name.isupper() and isinstance(value, str) and " " in value}
    assert status_texts == set(ADVICES)
