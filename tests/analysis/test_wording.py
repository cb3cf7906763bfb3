"""What `make lint` says of subjects of commits and of lines of Markdown."""

from wording import added, long_lines, long_subjects, prose


def test_subjects():
    assert not long_subjects("abc " + 72 * "x" + "\nabd short\n")
    (message,) = long_subjects("abc short\nabd " + 73 * "x" + "\n")
    assert "commit abd" in message and "73" in message


def test_tables_and_code_are_no_prose():
    text = "one\n| a table |\n```sh\ncode\n```\n<!-- HTML -->\n![picture](a.png)\n[link](b.md)\ntwo [link](b.md)\n"
    assert list(prose(text)) == [(1, "one"), (9, "two [link](b.md)")]


def test_only_added_lines_count():
    diff = "+++ b/x.md\n@@ -1,0 +2,2 @@\n+first\n+second\n@@ -9 +12 @@\n-old\n+third\n"
    assert added(diff) == {2, 3, 12}
    text = 121 * "x" + "\n" + 121 * "y" + "\nshort\n"
    (message,) = long_lines("x.md", text, added(diff))
    assert message.startswith("x.md:2: 121")
