"""Another script in place of one that a library is run by in a process of its own."""

import sys


def run_instead(monkeypatch, folder, script):
    """Let every Python that this process starts run the script, whatever it is to run."""
    program = folder / "python"
    program.write_text(f"#!{sys.executable}\n{script}\n")
    program.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(program))
