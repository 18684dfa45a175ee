"""Metrics read from a program's own state on request, so that its work need not count."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import REGISTRY, Collector

Labels = tuple[str, ...]
Values = Mapping[Labels, float]


@dataclass(frozen=True)
class Described:
    """A metric and its description. A counter's name has no `_total`, which is appended on output."""

    name: str
    meaning: str
    labels: Sequence[str] = ()
    is_counter: bool = False

    def family(self, values: Values) -> Metric:
        kind = CounterMetricFamily if self.is_counter else GaugeMetricFamily
        family = kind(self.name, self.meaning, labels=list(self.labels))
        for labels, value in values.items():
            family.add_metric(list(labels), value)
        return family


class SnapshotCollector(Collector):
    """`read` returns the values of each of `described` by its name; missing ones are unknown at present."""

    def __init__(self, described: Iterable[Described], read: Callable[[], Mapping[str, Values]]) -> None:
        self.described = tuple(described)
        self._read = read

    def describe(self) -> Iterator[Metric]:
        for one in self.described:
            yield one.family({})

    def collect(self) -> Iterator[Metric]:
        values = self._read()
        for one in self.described:
            if one.name in values:
                yield one.family(values[one.name])

    def __enter__(self) -> "SnapshotCollector":
        REGISTRY.register(self)
        return self

    def __exit__(self, *_: object) -> None:
        REGISTRY.unregister(self)
