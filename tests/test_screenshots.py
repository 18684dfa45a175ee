"""docs/screenshots holds what documents show, and little of it."""

from tests.browser.pictures import MAX_PICTURE_BYTES, SHOWN_PICTURES, shown_names

MAX_PICTURES = 30


def test_every_picture_is_shown_by_a_document() -> None:
    assert {path.name for path in SHOWN_PICTURES.iterdir()} == {f"{name}.webp" for name in shown_names()}


def test_there_are_few_pictures_and_each_is_small() -> None:
    sizes = {path.name: path.stat().st_size for path in SHOWN_PICTURES.iterdir()}
    assert len(sizes) <= MAX_PICTURES
    assert {name: size for name, size in sizes.items() if size > MAX_PICTURE_BYTES} == {}
