"""Voltages that cannot be, or that no network is known to use."""

from collections.abc import Sequence
from typing import Any

from shapely import Point

from inspection.network.infrastructure import Ways
from inspection.quality.infrastructure import GapGround, WayFacts, asset_key
from inspection.quality.issue import Gap

MAX_V = 1_200_000  # the highest that was ever in service: 1,150 kV Ekibastuz to Kokshetau, 1,200 kV as tested at Bina
MAX_VALUES = 6
LOW_VOLTAGE_V = 1_000

# Nominal voltages in use [V]: IEC 60038 and ANSI C84.1, railways (EN 50163), and what national networks use besides; above
# 100 kV also those of direct current links.
STANDARD_V = frozenset(
    round(kilovolts * 1_000)
    for kilovolts in (
        0.1, 0.11, 0.12, 0.127, 0.2, 0.208, 0.22, 0.23, 0.24, 0.277, 0.347, 0.38, 0.4, 0.415, 0.44, 0.46, 0.48, 0.5, 0.55, 0.575, 0.6,
        0.63, 0.65, 0.69, 0.75, 0.8, 0.825, 0.85, 0.9, 0.95, 1, 1.2, 1.25, 1.35, 1.5, 1.65, 2, 2.2, 2.3, 2.4, 3, 3.3, 3.6, 4, 4.16, 4.4,
        4.8, 5, 5.2, 5.5, 6, 6.25, 6.3, 6.35, 6.5, 6.6, 6.9, 7.2, 7.6, 7.62, 7.97, 8, 8.32, 8.4, 10, 10.5, 11, 11.4, 11.5, 12, 12.47,
        12.5, 12.7, 13, 13.2, 13.8, 14, 14.4, 15, 15.75, 16, 16.5, 17.3, 17.5, 18, 18.2, 19, 19.05, 19.1, 19.9, 20, 20.6, 20.8, 21, 21.6,
        22, 22.8, 22.86, 22.9, 23, 23.9, 24, 24.9, 24.94, 25, 26, 26.4, 27, 27.5, 27.6, 28, 30, 31.5, 33, 34, 34.4, 34.5, 35, 36, 37.5,
        38, 40, 41.6, 42, 43.8, 44, 45, 46, 47, 48, 49, 49.5, 50, 51, 52, 54, 55, 57, 57.1, 59, 60, 61, 62, 63, 64, 65, 66, 67, 69, 70,
        70.6, 71, 72, 72.5, 75, 77, 80, 82.5, 84, 85, 86, 87, 88, 90, 92, 95, 98, 99, 100, 104, 105, 106, 110, 111, 112, 113, 114, 115,
        117, 118, 119, 120, 121, 123, 125, 127, 128, 130, 132, 135, 138, 140, 143, 144, 145, 150, 154, 155, 158, 160, 161, 162, 163, 164,
        165, 166, 169, 170, 180, 185, 187, 200, 204, 220, 222, 225, 230, 235, 240, 242, 245, 250, 260, 270, 275, 280, 285, 287, 287.5,
        300, 315, 320, 330, 345, 350, 360, 362, 380, 400, 410, 420, 430, 450, 463, 480, 500, 515, 525, 530, 533, 535, 550, 600, 640, 660,
        735, 750, 765, 800, 1_000, 1_050, 1_100, 1_150, 1_200,
    )
)  # fmt: skip


def impossible_voltages(ground: GapGround) -> list[Gap]:
    """One gap for each line or railway whose voltage is too low for it, too high for any, no nominal one, or one of too many."""
    return [
        *_of_ways(ground.lines, ground.line_facts, is_railway=False),
        *_of_ways(ground.railways, ground.railway_facts, is_railway=True),
    ]


def _of_ways(ways: Ways, facts: WayFacts, *, is_railway: bool) -> list[Gap]:
    gaps = []
    for way, (volts, text) in enumerate(zip(facts.voltages_v, facts.voltage_text, strict=True)):
        fault = voltage_fault(volts, text, subtype=facts.subtype[way], is_railway=is_railway)
        if fault is None:
            continue
        asset, first, last = int(ways.asset[way]), int(ways.first[way]), int(ways.first[way + 1])
        middle = ways.position[(first + last) // 2]
        gaps.append(
            Gap(
                kind="impossible_voltage",
                key=f"impossible_voltage {asset_key('w', int(facts.osm_id[way]), asset)}",
                asset=asset,
                position=(float(middle[0]), float(middle[1])),
                geometry=Point(middle),
                details=fault | {"voltages_v": list(volts), "tagged": text[:200]},
            )
        )
    return gaps


def voltage_fault(volts: Sequence[int], text: str, *, subtype: str, is_railway: bool) -> dict[str, Any] | None:
    """None, or what is wrong: {"fault": too_low, too_high, too_many, unread or unusual, "is_advisory", "offered_v"}."""
    if not volts:
        return _fault("unread", []) if text.strip() and not _says_unknown(text) and not is_railway else None
    if any(value > MAX_V for value in volts):
        return _fault("too_high", _corrected(volts, lambda value: value > MAX_V, (1_000, 10, 100)))
    if not is_railway and subtype == "line" and (low := [value for value in volts if _is_too_low(value)]):
        return _fault("too_low", sorted({value * 1_000 if value in low else value for value in volts}, reverse=True))
    if len(volts) > MAX_VALUES:
        return _fault("too_many", [])
    if any(value not in STANDARD_V for value in volts):
        return _fault("unusual", [], is_advisory=True)
    return None


def _fault(name: str, offered_v: list[int], *, is_advisory: bool = False) -> dict[str, Any]:
    return {"fault": name, "offered_v": offered_v, "is_advisory": is_advisory}


def _is_too_low(value: int) -> bool:
    """A line on towers has high voltage: so few volts are kilovolts whose unit was left out, "110" for 110 kV."""
    return value < LOW_VOLTAGE_V and value * 1_000 in STANDARD_V


def _corrected(volts: Sequence[int], is_wrong: Any, divisors: Sequence[int]) -> list[int]:
    """The same voltages with the wrong ones divided so that they are nominal ones; none if that does not work for all."""
    corrected = set()
    for value in volts:
        fitting = [value // by for by in divisors if value % by == 0 and value // by >= LOW_VOLTAGE_V and value // by in STANDARD_V]
        if is_wrong(value) and not fitting:
            return []
        corrected.add(fitting[0] if is_wrong(value) else value)
    return sorted(corrected, reverse=True)


def _says_unknown(text: str) -> bool:
    return text.strip().lower() in {"unknown", "fixme", "?", "yes", "no"}
