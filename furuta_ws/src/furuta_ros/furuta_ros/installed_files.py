"""Finds the files that come with a package: inside the wheel, or where ament installed them."""

from pathlib import Path

# The wheel carries the files here. An ament workspace has no such folder.
IN_WHEEL = Path(__file__).with_name("share")


def share_directory(package: str) -> Path:
    """The folder with the files of a package."""
    if IN_WHEEL.is_dir():
        return IN_WHEEL / package
    # The wheel does not need it, so it is imported only here.
    from ament_index_python.packages import get_package_share_directory  # noqa: PLC0415

    return Path(get_package_share_directory(package))
