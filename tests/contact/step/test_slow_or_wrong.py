"""The page on slow and wrong runs: each command prints the lines below it; a cure does not print all lines of its symptom, nor a symptom those of its cure."""

import re

import pytest
from conftest import ROOT

PAGE = (ROOT / "options/slow-or-wrong/README.md").read_text()
BLOCKS = re.compile(r"^```sh\nbuild/impakt (.*?)\n```\n\n```text\n(.*?)\n```$", re.MULTILINE | re.DOTALL)
# Per case: options and lines of the symptom, and of the cure
CASES = {section.split("\n")[0]: BLOCKS.findall(section) for section in PAGE.split("\n## ")[1:]}


def pattern(line):
    """`...` stands for what is left out."""
    return re.compile("^" + ".*".join(re.escape(part) for part in line.split("...")) + "$", re.MULTILINE)


def missing(lines, text):
    return [line for line in lines if not pattern(line).search(text)]


def test_five_cases():
    assert len(CASES) == 5
    assert all(len(case) == 2 for case in CASES.values()), "a symptom and a cure, each a command with its lines"
    assert len(BLOCKS.findall(PAGE)) == PAGE.count("```sh") == PAGE.count("```text")


@pytest.mark.parametrize("name", CASES)
def test_case(name, impakt):
    texts = []
    for options, lines in CASES[name]:
        run = impakt(options)
        texts.append(run.stdout + run.stderr)
        assert not missing(lines.split("\n"), texts[-1])
    symptom, cure = (lines.split("\n") for _, lines in CASES[name])
    # what shows the cause is gone, and what shows the cure was not there before
    assert missing(symptom, texts[1])
    assert missing(cure, texts[0])
