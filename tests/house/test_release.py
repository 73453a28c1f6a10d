"""What a release says of itself."""

import re
import tomllib

import symflex
from tests.house.repository import ROOT


def test_the_citation_names_the_version_licence_and_authors_of_the_package():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    said = dict(
        re.findall(r"^([a-z-]+): (\S+)$", (ROOT / "CITATION.cff").read_text(encoding="utf-8"), re.MULTILINE)
    )
    assert (said["version"], said["license"]) == (symflex.__version__, project["license"].split(" AND ")[0])
    assert said["cff-version"] == "1.2.0"
    assert f"- name: {project['authors'][0]['name']}" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def test_the_wheel_holds_the_examples():
    build = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["hatch"]["build"]
    assert build["targets"]["wheel"]["force-include"] == {"derivations": "symflex/derivations"}
