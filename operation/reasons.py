"""Reasons as a code and the parameters of its sentence. Sentences are English; `workspace/reason_texts.py` translates them."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any


def gettext_noop(sentence: str) -> str:
    """Mark a sentence for translation."""
    return sentence


def ngettext_noop(singular: str, plural: str) -> tuple[str, str]:
    """Mark a sentence that has a plural for translation."""
    return singular, plural


Sentences = Mapping[str, str | tuple[str, str]]  # by code; a pair is the singular and the plural, chosen by the parameter `count`
SENTENCES: dict[str, str | tuple[str, str]] = {"text": "%(text)s"}  # of all packages; `text` comes from a vehicle or a library


def register_sentences(sentences: Sentences) -> Sentences:
    """Register codes. Raises ValueError for a code that already has another sentence."""
    for code, sentence in sentences.items():
        if SENTENCES.setdefault(code, sentence) != sentence:
            raise ValueError(f"two sentences for the code {code}")
    return sentences


MINUTES = gettext_noop("%(sentence)s: %(minutes)s min of flight.")
OR = gettext_noop("or")
MAX_NAMED = 3  # UAVs that a reason names; the others are counted


@dataclass(frozen=True)
class Wording:
    """Text functions of one language: gettext, ngettext, and the text of a number with a number of decimals."""

    gettext: Callable[[str], str]
    ngettext: Callable[[str, str, int], str]
    number: Callable[[float, int], str]


ENGLISH = Wording(lambda text: text, lambda one, many, count: one if count == 1 else many, lambda value, decimals: f"{value:,.{decimals}f}")


@dataclass(frozen=True)
class Reason:
    """A reason. code is a key of SENTENCES; params fill its sentence.

    A param is a text, a number, a Reason, or a sequence of texts or Reasons; a number whose name ends in _m, _km or _wh is written with its
    unit. `minutes` of flight, if given, are appended to a sentence that has no place for them.
    """

    code: str
    params: Mapping[str, Any] = field(default_factory=dict)

    def __str__(self) -> str:
        return self.text(ENGLISH)

    def text(self, wording: Wording) -> str:
        """Return the sentence in the language of the wording."""
        sentence = SENTENCES[self.code]
        words = wording.gettext(sentence) if isinstance(sentence, str) else wording.ngettext(*sentence, self.params["count"])
        words = words % {name: _text(name, value, wording) for name, value in self.params.items()}
        if "minutes" in self.params and "%(minutes)s" not in sentence:
            minutes = wording.number(self.params["minutes"], 1)
            words = wording.gettext(MINUTES) % {"sentence": words.removesuffix("."), "minutes": minutes}
        return words

    def to_json(self) -> dict[str, Any]:
        return {"code": self.code, "params": {name: _to_json(value) for name, value in self.params.items()}}


def text_reason(text: str) -> Reason:
    """Return a reason with the unchanged text of a vehicle, a companion or a library."""
    return Reason("text", {"text": text})


# Reasons, or a text from elsewhere.
Why = Reason | Sequence[Reason] | str


def reason_of(error: Exception) -> "Reason | str":
    """Return the reason with which an exception was raised, or its text without one."""
    return error.args[0] if error.args and isinstance(error.args[0], Reason) else str(error)


def reasons_of(why: Why) -> Sequence[Reason]:
    """Return the reasons; none for a text."""
    return () if isinstance(why, str) else (why,) if isinstance(why, Reason) else why


def english(why: Why, separator: str = " ") -> str:
    """Return the sentences in English, joined."""
    return why if isinstance(why, str) else separator.join(map(str, reasons_of(why)))


def reason_from_json(value: Mapping[str, Any]) -> Reason:
    """Return the inverse of Reason.to_json. Raises KeyError for an unknown code."""
    SENTENCES[value["code"]]
    return Reason(value["code"], {name: _from_json(param) for name, param in value["params"].items()})


def _to_json(value: Any) -> Any:
    if isinstance(value, Reason):
        return value.to_json()
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_to_json(one) for one in value]
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value


def _from_json(value: Any) -> Any:
    if isinstance(value, dict):
        return reason_from_json(value)
    return [_from_json(one) for one in value] if isinstance(value, list) else value


def _text(name: str, value: Any, wording: Wording) -> str:
    if isinstance(value, Reason):
        return value.text(wording)
    if isinstance(value, str):
        return value
    if isinstance(value, Sequence):
        return _list_text(name, [_text("", one, wording) for one in value], wording)
    if name.endswith("_km"):
        return f"{wording.number(value, 0 if value == round(value) else 1)} km"
    if name.endswith("_m"):
        return f"{wording.number(value, 0)} m" if value < 1_000 else f"{wording.number(value / 1_000, 1)} km"
    if name.endswith("_wh"):
        return f"{wording.number(value, 1)} Wh"
    return _figure_text(value, wording) if isinstance(value, float) else str(value)


def _figure_text(value: float, wording: Wording) -> str:
    """Return the number with at most six digits, without trailing zeros."""
    shown = f"{value:g}"
    return wording.number(value, len(shown.partition(".")[2])) if "." in shown and "e" not in shown else shown


def _list_text(name: str, words: Sequence[str], wording: Wording) -> str:
    """Join the texts: all of `limits` and `parts`, `any_uav` with "or", and of other names the first few."""
    if name in ("limits", "parts"):
        return ("; " if name == "limits" else ", ").join(words)
    if name == "any_uav":
        return f" {wording.gettext(OR)} ".join(words)
    more = len(words) - MAX_NAMED
    return ", ".join(words[:MAX_NAMED]) + (f" +{more}" if more > 0 else "")
