"""Estimates of flights that went as flights go: nearer than two ways without a filter, and within their bounds 95 times of 100."""

import pytest

from tests.telemetry.estimation.routes import lines_of
from tests.telemetry.estimation.scoring import Score, rms, score_flights, share


def is_better_than_both(score: Score) -> bool:
    return rms(score.error_m) < min(rms(score.held_m), rms(score.straight_m))


def test_a_few_flights_are_estimated_well_at_every_report_interval():
    for every_s, score in score_flights(range(2)).items():
        assert len(score.error_m) > 600
        assert is_better_than_both(score), every_s
        assert 0.88 <= share(score.inside) <= 0.995, (every_s, share(score.inside))  # of two flights: errors of GPS are shared by reports
        assert share(score.height_inside) >= 0.85
        assert share(score.speed_inside) >= 0.85


def keeps_bars(every_s: float, score: Score) -> None:
    """Nobody foresees a pause: arrivals after one are later than their bounds, and a bound that held them would say nothing."""
    assert is_better_than_both(score), every_s
    assert 0.93 <= share(score.inside) <= 0.97, (every_s, share(score.inside))
    assert share(score.height_inside) >= 0.90, (every_s, share(score.height_inside))
    assert share(score.speed_inside) >= 0.90, (every_s, share(score.speed_inside))
    assert share(score.arrival_inside) >= 0.88, (every_s, share(score.arrival_inside))


@pytest.mark.long
@pytest.mark.parametrize(
    "names",
    [
        pytest.param(["elme-valley.osm.pbf", "quillmoor.osm.pbf"], id="generated"),
        pytest.param(["nepal-power-2025.osm.pbf", "liechtenstein-2021-infra.osm.pbf"], id="real"),
    ],
)
def test_200_flights_keep_the_bars(names, region_file, record_property):
    lines = [line for name in names for line in lines_of(region_file(name))]
    for every_s, score in score_flights(range(200), lines).items():
        record_property("figure", f"a report in {every_s:g} s: inside {share(score.inside):.1%}")
        keeps_bars(every_s, score)


@pytest.mark.long
def test_200_flights_along_drawn_lines_keep_the_bars(record_property):
    for every_s, score in score_flights(range(200)).items():
        record_property("figure", f"drawn lines, a report in {every_s:g} s: inside {share(score.inside):.1%}")
        keeps_bars(every_s, score)
