import dataclasses
import re
import typing
from pathlib import Path

import pytest

import pumpmodel as pm
from pumpmodel import choices
from pumpmodel._pumpmodel import _choices
from pumpmodel.plotting.waveform import _PANELS

TYPES = {name: typing.get_args(of) for name, of in vars(choices).items() if typing.get_args(of)}
# The words of these are in Python alone.
IN_PYTHON = {"Identification", "Panel", "SteadyQuantity"}


def test_every_type_has_the_words_of_the_library() -> None:
    library = dict(_choices())
    assert set(TYPES) - IN_PYTHON == set(library)
    for name, words in library.items():
        assert sorted(TYPES[name]) == sorted(words), name


def test_the_types_of_pictures_and_kinds_have_the_words_that_are_taken() -> None:
    assert TYPES["Panel"] == tuple(_PANELS)
    # A sweep has its pumps and both speeds, then its results.
    assert TYPES["SteadyQuantity"] == tuple(field.name for field in dataclasses.fields(pm.Sweep)[3:])
    found = (
        pm.identify_resistance([10, 20, 40, 60], drop_kpa=[1.11, 2.21, 4.44, 6.64]),
        pm.identify_compliance([0, 0.1, 0.2, 0.3, 0.4], [88.6, 91.4, 94.2, 96.9, 99.7]),
    )
    kinds = [one.kind for one in found]
    assert kinds == list(TYPES["Identification"][:2])


@pytest.mark.parametrize("words", [words for words in TYPES.values() if len(words) > 1])
def test_no_other_file_repeats_the_words_of_a_choice(words: tuple[str, ...]) -> None:
    folder = Path(pm.__file__).parent
    repeated = re.compile(r"Literal\[\s*" + r",\s*".join(f'"{re.escape(word)}"' for word in words))
    sources = [*folder.rglob("*.py"), *folder.rglob("*.pyi")]
    found = [source.name for source in sources if repeated.search(source.read_text())]
    assert found == ["choices.py"]
