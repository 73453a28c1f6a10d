from tests.house.repository import ROOT, blocks

SHELL = ("sh", "bash", "shell", "console")


def commands():
    return [
        line
        for block in blocks(ROOT / "README.md")
        if block.language in SHELL
        for line in block.text.splitlines()
    ]


def test_the_readme_has_exactly_two_commands():
    assert commands() == [
        "python -m pip install . && symflex report derivations/eppinger1988",
        "python -m pip install '.[test]' && python -m pytest",
    ]


def test_ci_reads_its_test_command_from_the_readme():
    assert not any(command in (ROOT / ".ci" / "run").read_text(encoding="utf-8") for command in commands())
