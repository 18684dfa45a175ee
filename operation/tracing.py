"""OpenTelemetry, if SPANWISE_TRACING is set and requirements-tracing.txt is installed. Otherwise none of it is imported.

OpenTelemetry's own variables (OTEL_EXPORTER_OTLP_ENDPOINT and so on) set the destination of spans. No span holds a header, a body or
the parameters of a statement.
"""

import importlib
import logging
import os
from typing import Any

from operation.version import VERSION

logger = logging.getLogger(__name__)

VARIABLE = "SPANWISE_TRACING"
NOT_TRACED = "healthz,readyz,invitation/,new-password/,email-address/,single-sign-on/callback"  # spans hold addresses
_MISSING = "%s is set, but OpenTelemetry is not installed (requirements-tracing.txt): nothing is traced"

_begun = False


def is_wanted() -> bool:
    return os.environ.get(VARIABLE, "0").lower() in {"1", "true", "yes", "on"}


def begin_tracing(program: str) -> bool:
    """Start tracing, once per process and after a fork. Returns whether spans are made from now on."""
    global _begun
    if _begun or not is_wanted():
        return _begun
    try:
        _provide(program)
        _instrument(program)
    except ImportError:
        logger.warning(_MISSING, VARIABLE)
        return False
    _begun = True
    return True


def _of(module: str, name: str) -> Any:
    return getattr(importlib.import_module(module), name)


def _provide(program: str) -> None:
    resource = _of("opentelemetry.sdk.resources", "Resource").create({"service.name": f"spanwise-{program}", "service.version": VERSION})
    provider = _of("opentelemetry.sdk.trace", "TracerProvider")(resource=resource)
    exporter = _of("opentelemetry.exporter.otlp.proto.http.trace_exporter", "OTLPSpanExporter")()
    provider.add_span_processor(_of("opentelemetry.sdk.trace.export", "BatchSpanProcessor")(exporter))
    _of("opentelemetry.trace", "set_tracer_provider")(provider)


def _instrument(program: str) -> None:
    """Instrument requests and tasks, joined by a header, and statements without their parameters."""
    if program == "web":
        os.environ.setdefault("OTEL_PYTHON_DJANGO_EXCLUDED_URLS", NOT_TRACED)
        _of("opentelemetry.instrumentation.django", "DjangoInstrumentor")().instrument()
    if program in {"web", "worker", "beat"}:
        _of("opentelemetry.instrumentation.celery", "CeleryInstrumentor")().instrument()
    _of("opentelemetry.instrumentation.psycopg", "PsycopgInstrumentor")().instrument()
