"""What a ROS package carries: a valid package.xml, its metadata and licence."""

import pytest
import yaml
from catkin_pkg.package import Package, parse_package
from sources import PACKAGES, ROOT, SOURCES, setup_options


def parsed(package: str) -> Package:
    """The package.xml as ROS tools read it; raises an error if it is not valid."""
    return parse_package(str(SOURCES / package), warnings=[])


@pytest.mark.parametrize("package", PACKAGES)
def test_manifest_is_valid(package: str) -> None:
    """Format 3, without errors or warnings, named as its folder."""
    warnings: list[str] = []
    manifest = parse_package(str(SOURCES / package), warnings=warnings)
    assert (manifest.name, manifest.package_format, warnings) == (package, 3, [])


@pytest.mark.parametrize("package", PACKAGES)
def test_setup_has_the_metadata_of_the_manifest(package: str) -> None:
    """Description, version, licence, address, author and maintainer are the same in both."""
    manifest, given = parsed(package), setup_options(package)["metadata"]
    (url,), (author,), (maintainer,) = manifest.urls, manifest.authors, manifest.maintainers
    assert dict(given) == {
        "name": manifest.name,
        "version": manifest.version,
        "description": manifest.description,
        "license": manifest.licenses[0],
        "url": url.url,
        "author": author.name,
        "author_email": author.email,
        "maintainer": maintainer.name,
        "maintainer_email": maintainer.email,
    }


def test_packages_have_the_same_version_and_address() -> None:
    """They are released together, and cited so."""
    manifests = [parsed(package) for package in PACKAGES]
    ((version, url, author),) = {(m.version, m.urls[0].url, m.authors[0].name) for m in manifests}
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert (cited["version"], cited["repository-code"]) == (version, url)
    assert cited["authors"] == [{"name": author}]


@pytest.mark.parametrize("package", PACKAGES)
def test_licence_is_the_one_of_the_workspace(package: str) -> None:
    """A copy, because a package is also released alone."""
    assert (SOURCES / package / "LICENSE").read_bytes() == (ROOT / "LICENSE").read_bytes()
