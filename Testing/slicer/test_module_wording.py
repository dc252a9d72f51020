"""Texts for a user of Slicer do not mention the command line: that user has none."""

import ast
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

RASTRAINER = Path(__file__).parents[2] / "RASTrainer"
LOGIC = RASTRAINER / "Logic" / "rastrainer"
COMMANDS = "simulator|scenario|demo|doctor|study|head|score|register|export|report"
WORDS = re.compile(rf"(?<![\w-])--[a-z]|\brastrainer ({COMMANDS})\b|command line|terminal|\bpip\b")


def sentences(path):
    """Yield the texts passed to the translation or to an error."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        name = isinstance(node, ast.Call) and ast.unparse(node.func)
        if name == "_" or (name and name.endswith("Error")):
            parts = [n for argument in node.args for n in ast.walk(argument)]
            yield " ".join(
                part.value
                for part in parts
                if isinstance(part, ast.Constant) and isinstance(part.value, str)
            )


def test_no_sentence_and_no_widget_of_the_module_mentions_the_command_line():
    said = [
        (path.name, sentence)
        for path in (RASTRAINER / "RASTrainer.py", *LOGIC.rglob("*.py"))
        for sentence in sentences(path)
    ]
    said += [
        (path.name, string.text or "")
        for path in (RASTRAINER / "Resources" / "UI").glob("*.ui")
        for string in ElementTree.parse(path).iter("string")
    ]
    assert len(said) > 500
    assert [place for place in said if WORDS.search(place[1])] == []
