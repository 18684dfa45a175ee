"""Gaps in words: a title for the list and one sentence that says what is wrong."""

from typing import Any

Details = dict[str, Any]


def kilometres(metres: float) -> str:
    """ "11.3 km", "0.32 km": for spans, which are compared with each other. The space does not break."""
    return f"{metres / 1_000:.2f}\N{NO-BREAK SPACE}km" if metres < 1_000 else f"{metres / 1_000:,.1f}\N{NO-BREAK SPACE}km"


def length(metres: float) -> str:
    """ "2.6 m", "698 m", "34.2 km"."""
    if metres < 999.5:
        return f"{metres:.{1 if metres < 20 else 0}f}\N{NO-BREAK SPACE}m"
    return kilometres(metres)


def title(kind: str, details: Details) -> str:
    """A few words; the asset's own name stands beside them."""
    match kind:
        case "long_span":
            return f"Span of {kilometres(details['span_m'])}"
        case "missing_support":
            return f"{_count(details['missing_towers'], 'tower')} missing"
        case "line_without_towers":
            return "Line without towers"
        case "tower_on_no_line":
            return "Tower on no line" if details["towers"] == 1 else f"{details['towers']:,} towers on no line"
        case "dead_end":
            return "Line ends in nothing"
        case "ends_apart":
            return f"Lines {length(details['apart_m'])} apart"
        case "bridge_without_way":
            return "Bridge without a way"
        case _:
            return {
                "unusual": "Unusual voltage", "unread": "Voltage not readable", "too_many": f"{len(details['voltages_v'])} voltages",
            }.get(details["fault"], "Impossible voltage")  # fmt: skip


def sentence(kind: str, details: Details) -> str:
    """What is wrong, then what follows from it."""
    return _SENTENCES[kind](details)


def _long_span(details: Details) -> str:
    said = f"Span of {kilometres(details['span_m'])}; the usual one here is {kilometres(details['usual_span_m'])}."
    missing = details["missing_towers"]
    said += f" About {missing} towers are missing." if missing > 1 else " About one tower is missing."
    return said + (" No span in the world is so long." if details["is_impossible"] else "")


def _missing_support(details: Details) -> str:
    return (
        f"{details['missing_towers']} of {details['vertices']} vertices have no tower; "
        f"{length(details['without_tower_m'])} of the line cannot be picked tower by tower."
    )


def _line_without_towers(details: Details) -> str:
    return f"None of the line's {details['vertices']} vertices has a tower: {length(details['line_m'])} cannot be picked tower by tower."


def _tower_on_no_line(details: Details) -> str:
    near = details["nearest_line_m"]
    if details["towers"] > 1:
        said = f"{details['towers']:,} towers in a row of {length(details['row_m'])} carry no line"
        return f"{said}; the nearest one is {length(near)} away." if near is not None else f"{said}: it may not be mapped."
    if near is None:
        return "No line passes the tower, and none is within 500 m."
    return f"No line passes the tower; the nearest one is {length(near)} away."


def _dead_end(details: Details) -> str:
    what = "The line ends at a tower" if details["has_tower"] else "The line ends at a vertex without a tower"
    said = f"{what}, and nothing is within 150 m that it could lead to."
    near = details["nearest_m"]
    return said if near is None else f"{said} Another part of the network is {length(near)} away."


def _ends_apart(details: Details) -> str:
    other = "the other line's end" if details["is_at_end"] else "another line"
    return f"The line ends {length(details['apart_m'])} from {other} and does not join it."


def _bridge_without_way(details: Details) -> str:
    return "Nothing says what the bridge carries: no road, railway, path or water is mapped on it."


def _impossible_voltage(details: Details) -> str:
    volts = ", ".join(f"{value:,} V" for value in details["voltages_v"])
    match details["fault"]:
        case "too_low":
            return f"{volts}: too low for a line on towers. The unit was probably left out."
        case "too_high":
            return f"{volts}: no line in the world has more than 1,200 kV."
        case "too_many":
            return f"{len(details['voltages_v'])} voltages on one line: {volts}."
        case "unread":
            return f"The voltage “{details['tagged']}” cannot be read."
        case _:
            return f"{volts}: no network is known to use it. It may be right all the same."


def _count(number: int, word: str) -> str:
    return f"{number:,} {word}{'' if number == 1 else 's'}"


_SENTENCES = {
    "long_span": _long_span,
    "missing_support": _missing_support,
    "line_without_towers": _line_without_towers,
    "tower_on_no_line": _tower_on_no_line,
    "dead_end": _dead_end,
    "ends_apart": _ends_apart,
    "bridge_without_way": _bridge_without_way,
    "impossible_voltage": _impossible_voltage,
}
