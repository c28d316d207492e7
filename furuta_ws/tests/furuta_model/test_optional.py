"""A package that is missing is named in one line."""

import pytest

from furuta_model.optional import needed_by


def test_missing_package_is_named() -> None:
    """With what pip installs; the name stays, by which the command line knows it."""
    with pytest.raises(ModuleNotFoundError) as error, needed_by("this"):
        raise ModuleNotFoundError("No module named 'flint.flint'", name="flint.flint")
    text = "this needs flint, which is not installed: pip install python-flint"
    assert (str(error.value), error.value.name) == (text, "flint")
