"""What `make lint` checks of words: subjects of commits have at most 72 characters, new lines of prose in Markdown at most 120.

Commits and lines since BASE count. Tables, code, links and pictures that fill a line alone, and HTML are not prose.
"""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BASE = "b849838f9be8a23ceb740f68ab2c515b1a3a98b7"
SUBJECT, PROSE = 72, 120  # characters
HUNK = re.compile(r"^@@ -\S+ \+(\d+)")


def git(*words):
    done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False)
    return done.stdout if done.returncode == 0 else None


def long_subjects(log):
    """Of lines `hash subject`."""
    return [f"commit {line.partition(' ')[0]}: its subject has {len(line.partition(' ')[2])} characters, more than {SUBJECT}" for line in log.splitlines() if len(line.partition(" ")[2]) > SUBJECT]


def prose(text):
    """Numbers and lines of a Markdown text that are prose."""
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("```"):
            fenced = not fenced
        elif not fenced and not re.match(r"\||<|    |!?\[[^\]]*\]\([^)]*\)$", line):
            yield number, line


def added(diff):
    """Numbers of the added lines in a `git diff -U0` of one file."""
    numbers, number = set(), 0
    for line in diff.splitlines():
        hunk = HUNK.match(line)
        if hunk:
            number = int(hunk[1])
        elif line.startswith("+") and not line.startswith("+++"):
            numbers.add(number)
            number += 1
    return numbers


def long_lines(name, text, new):
    return [f"{name}:{number}: {len(line)} characters of prose, more than {PROSE}" for number, line in prose(text) if number in new and len(line) > PROSE]


def main():
    log = git("log", "--format=%h %s", f"{BASE}..HEAD")
    if log is None:
        print(f"lint: not in a checkout with commit {BASE[:8]}: subjects of commits and lines of Markdown are not checked", file=sys.stderr)
        return 0
    found = long_subjects(log)
    for name in git("ls-files", "-co", "--exclude-standard", "*.md").splitlines():
        if (ROOT / name).exists():
            text = (ROOT / name).read_text()
            tracked = git("cat-file", "-e", f"{BASE}:{name}") is not None
            new = added(git("diff", "-U0", BASE, "--", name)) if tracked else range(1, text.count("\n") + 2)
            found += long_lines(name, text, new)
    print("\n".join(found), file=sys.stderr, end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
