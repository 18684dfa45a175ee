"""What gateways store of commands is read in the reader's language: every sentence that they can make is foreseen."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest
from django.utils.translation import override

from mavlink.commands.actions import Order
from missions.outcome_messages import PARTS, SENTENCES, is_foreseen, render_outcome

ROOT = Path(__file__).resolve().parents[2]
MAKERS = [
    *(ROOT / "telemetry" / "gateway" / f"{name}.py" for name in ("delivery", "preparation", "protocol_driver")),
    *(ROOT / "mavlink" / "commands" / f"{name}.py" for name in ("actions", "command", "driver")),
    *(ROOT / "mavlink" / "mission_sync" / f"{name}.py" for name in ("limits", "sync")),
    *(ROOT / "mavlink" / f"{name}.py" for name in ("parameters", "vehicle_class")),
]
# Of these a part that is put in makes another sentence; each is looked at below as it comes out.
VARIANTS = {"The {} {} m from", "The {} {} m {} the", "The UAV is {} m {} the", "The {} has {} items; {} {} {}."}
NOT_REPORTED = {"The UAV is so already.", "The vehicle holds {}."}  # notes of commands that were applied


def text_of(node: ast.AST) -> str | None:
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    if isinstance(node, ast.JoinedStr):
        return "".join(str(part.value) if isinstance(part, ast.Constant) else "{}" for part in node.values)
    return None


def sentences_of(path: Path) -> Iterator[str]:
    tree = ast.parse(path.read_text())
    inside = {id(part) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for part in ast.walk(node) if part is not node}
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    inside |= {id(node.body[0].value) for node in ast.walk(tree) if isinstance(node, documented) and isinstance(node.body[0], ast.Expr)}
    for node in ast.walk(tree):
        text = None if id(node) in inside else text_of(node)
        if text and text[:1].isupper() and " " in text and text.rstrip("{} ").endswith((".", ":")):
            yield text


@pytest.mark.parametrize("path", MAKERS, ids=lambda path: path.stem)
def test_every_sentence_that_a_gateway_makes_is_foreseen(path):
    reported = [text for text in sentences_of(path) if text not in NOT_REPORTED and not any(text.startswith(start) for start in VARIANTS)]
    assert reported
    assert [text for text in reported if not is_foreseen(text.removesuffix(" {}").replace("{}", "7"))] == []


@pytest.mark.parametrize(
    "stored",
    [
        "The UAV stands 120 m from the planned take-off; 100 m are allowed.",
        "The UAV's home is 120 m from the planned take-off; 100 m are allowed.",
        "The UAV reports 12 m below the planned take-off; 10 m are allowed.",
        "The UAV's home is 12 m above the planned take-off; 10 m are allowed.",
        "The UAV is 12 m above the leg that it would fly on; 10 m are allowed.",
        "The UAV would not fly it. The leg to item 4 is 962 m; MIS_DIST_WPS allows 900 m. So is one more leg."
        " Revoke, and approve it again with points put in on longer legs.",
        "The mission has 700 items; px4 on most boards takes 500. The UAV has not told how far apart waypoints may be.",
        "The fence has 70 items; ardupilot takes 64.",
        "Nothing was sent. The vehicle is a plane: Spanwise plans for and commands multicopters only.",
        "Nothing was sent. Not known to ArduPilot 4.3.0: item 7, IMAGE_START_CAPTURE (2000).",
        "Refused by ArduPilot 4.6.0: item 3 of the mission, NAV_WAYPOINT (16) (invalid-param7). The vehicle holds what it held before.",
        "Of the fence, item 3: latitude was sent as 55.4 and came back as 55.5. There are 4 more differences."
        " The vehicle holds what it held before.",
        "It was not sent in time. The UAV does not tell where its home is, from which it counts its heights.",
        "The fence on the UAV does nothing: FENCE_ENABLE 0.",
    ],
)
def test_what_is_put_together_is_foreseen(stored):
    assert is_foreseen(stored)
    with override("en"):
        assert render_outcome(stored) == stored


def test_each_sentence_is_read_as_itself():
    for sentence in SENTENCES:
        assert is_foreseen(sentence.replace("%(", "{").replace(")s", "}"))


def test_it_is_told_in_german_with_its_figures():
    with override("de"):
        assert render_outcome("The UAV stands 120 m from the planned take-off; 100 m are allowed.") == (
            "Das UAV steht 120 m vom geplanten Startplatz entfernt; 100 m sind erlaubt."
        )
        reported = render_outcome("Could not take-off, at leave the ground. The vehicle agreed, and nothing happened. Compass not healthy")
    assert reported.startswith(
        "„Abheben“ ging nicht, beim Schritt „vom Boden abheben“. Das Fahrzeug hat zugestimmt, und nichts ist geschehen."
    )
    assert reported.endswith(" Compass not healthy")


def test_what_a_vehicle_says_itself_stays_as_it_is():
    with override("de"):
        assert render_outcome("PreArm: Need 3D Fix. Check it.") == "PreArm: Need 3D Fix. Check it."
        assert render_outcome("") == ""


def test_every_order_has_a_word():
    assert {str(order) for order in Order} <= set(PARTS)
