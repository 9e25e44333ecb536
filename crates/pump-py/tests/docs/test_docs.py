import doctest

import pytest

import pumpmodel as pm


@pytest.mark.parametrize("name", ["", *pm.__all__])
def test_examples_in_docstrings_run(name: str) -> None:
    documented = getattr(pm, name) if name else pm
    assert documented.__doc__
    test = doctest.DocTestParser().get_doctest(documented.__doc__, {}, name or "pumpmodel", None, None)
    assert doctest.DocTestRunner().run(test).failed == 0


def test_every_public_name_has_a_docstring() -> None:
    for name in pm.__all__:
        documented = getattr(pm, name)
        assert documented.__doc__, name
        # Fields are documented with their class.
        bases = getattr(documented, "__mro__", ())
        fields = {field for base in bases for field in vars(base).get("__annotations__", {})}
        ours = [base for base in bases if base.__module__.startswith("pumpmodel")]
        for attribute in {attribute for base in ours for attribute in vars(base)} - fields:
            if not attribute.startswith("_"):
                assert getattr(documented, attribute).__doc__, f"{name}.{attribute}"
