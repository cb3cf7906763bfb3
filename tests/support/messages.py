"""What an error has to look like."""


def check_message(run, words):
    """One line by Impakt itself, which names all that it should."""
    lines = [line for line in run.stderr.splitlines() if line.startswith("impakt: error")]
    assert len(lines) == 1, run.stderr
    assert "PETSC ERROR" not in run.stderr
    missing = [word for word in words if word not in lines[0]]
    assert not missing, lines[0]
