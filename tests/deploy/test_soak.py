"""What a soak says of growth: right about a line, honest about noise that hangs together."""

import os

import numpy as np
import pytest

from deploy.load.day.sampling import files_of, memory_of
from deploy.load.day.slopes import FLAT, GROWS, NOT_DECIDED, slope
from deploy.load.usage import families

INTERVAL_S, SAMPLES = 10.0, 180  # half an hour
AT_S = np.arange(SAMPLES) * INTERVAL_S
MIB_400 = 400.0 * 2**20


def test_a_leak_of_three_percent_an_hour_is_said_to_grow() -> None:
    leaking = MIB_400 * (1.0 + 0.03 * AT_S / 3_600.0) + np.random.default_rng(1).normal(0.0, 2**18, SAMPLES)
    found = slope(AT_S, leaking)
    assert found.percent_per_h == pytest.approx(3.0, abs=0.2)
    assert found.verdict(1.0) == GROWS


def test_a_program_that_only_trembles_is_flat() -> None:
    assert slope(AT_S, MIB_400 + np.random.default_rng(2).normal(0.0, 2**18, SAMPLES)).verdict(1.0) == FLAT


def test_one_step_in_the_middle_is_no_certain_growth() -> None:
    """A line through it is steep; its faults hang together, and say that a line is not what happens."""
    stepped = np.where(AT_S[SAMPLES // 2] > AT_S, MIB_400, 1.01 * MIB_400) + np.random.default_rng(3).normal(0.0, 2**16, SAMPLES)
    found = slope(AT_S, stepped)
    assert found.percent_per_h > 1.0
    assert found.verdict(1.0) == NOT_DECIDED


def test_the_stated_bound_is_as_large_as_what_chance_does() -> None:
    """Of 200 series that wander and come back half way each time, 95 of 100 slopes lie within their bound of none."""
    draw, outside = np.random.default_rng(4), 0
    for _ in range(200):
        noise = np.zeros(SAMPLES)
        for place in range(1, SAMPLES):
            noise[place] = 0.5 * noise[place - 1] + draw.normal(0.0, 2**18)
        found = slope(AT_S, MIB_400 + noise)
        outside += abs(found.percent_per_h) > found.bound
    assert outside / 200 < 0.12


def test_what_does_not_change_has_no_slope() -> None:
    found = slope(AT_S, np.full(SAMPLES, MIB_400))
    assert (found.percent_per_h, found.bound, found.verdict(1.0)) == (0.0, 0.0, FLAT)


def test_memory_and_files_of_this_very_process_are_found() -> None:
    here = os.getpid()
    assert here in families({"tests": [os.getppid()]})["tests"]
    own, _ = memory_of(here)
    assert own > 2**20
    assert files_of(here) >= 3
    assert memory_of(2**22 + 1) == (0, 0)
