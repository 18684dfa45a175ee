"""A plan passes its own rehearsal in calm air, and takes the time and the energy that it says."""

import random
from pathlib import Path

import pytest

from tests.missions.flights import an_operator
from tests.simulation.rehearsals.random_rehearsals import Rehearsed, bring_in_demo_region, random_request, rehearse

pytestmark = pytest.mark.django_db

MAX_OFF = 0.05
OPERATORS_CHOICE = "obstacle-column"  # how near to something it takes off: the random places do not look for room


def faults_of(found: Rehearsed) -> list[str]:
    faults = [
        f"{finding.level} {finding.code} {dict(finding.facts)}" for finding in found.assessment.findings if finding.code != OPERATORS_CHOICE
    ]
    for kind, ratios in (("time", found.time), ("energy", found.energy)):
        faults += [f"{kind} planned for flown {ratio:.3f}" for ratio in ratios if abs(ratio - 1.0) > MAX_OFF]
    return faults


def check_missions(folder: Path, missions: int, seed: int) -> None:
    bring_in_demo_region(folder)
    person, draw = an_operator(), random.Random(seed)
    faults: list[str] = []
    flown = 0
    while flown < missions:
        found = rehearse(random_request(draw), person, flown)
        if found is not None:
            flown += 1
            faults += [f"mission {flown}: {fault}" for fault in faults_of(found)]
            print(flown, found.time, found.energy, faults_of(found), flush=True)
    assert not faults, "\n".join(faults)


@pytest.mark.long
def test_2_random_missions_pass_their_rehearsal(tmp_path: Path) -> None:
    check_missions(tmp_path, 2, seed=1)


@pytest.mark.long
@pytest.mark.parametrize("drawn", [62, 109], ids=["many sharp turns at 14 m/s", "short at 8 m/s"])
def test_a_mission_of_the_200_that_was_off_passes_its_rehearsal(tmp_path: Path, drawn: int) -> None:
    """Missions 62 and 107 of the 200: two of the draws before 107 cannot be flown. Planned for flown energy was 0.942 and 1.05007."""
    bring_in_demo_region(tmp_path)
    draw = random.Random(2)
    request = [random_request(draw) for _ in range(drawn)][-1]
    found = rehearse(request, an_operator(), drawn)
    assert found is not None
    assert not faults_of(found)


@pytest.mark.long
def test_200_random_missions_pass_their_rehearsal(tmp_path: Path) -> None:
    check_missions(tmp_path, 200, seed=2)
