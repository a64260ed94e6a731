"""The result of a check."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

REFUSE, DOUBT, NOTE = "refuse", "doubt", "note"


@dataclass(frozen=True)
class Finding:
    """One finding of a check before the run."""

    severity: str
    """``refuse``: no sensible result is possible; ``doubt``: likely a mistake; ``note``: worth
    knowing."""
    holds: str
    """What must hold, and why; empty where ``came`` says it all."""
    came: str
    """What came instead, or the finding as a sentence."""
    remedy: str
    """What to do."""
    forcible: bool = False
    """Whether a refusal can be overridden, because the run may make sense to an expert."""

    @property
    def word(self) -> str:
        """The word before it."""
        return {REFUSE: "refused", DOUBT: "distrust", NOTE: "note"}[self.severity]

    def __str__(self) -> str:
        if not self.holds:
            return f"{self.came}; {self.remedy}"
        return f"{self.holds}, got {self.came}: {self.remedy}"


def doubt(holds: str, came: str, remedy: str) -> Finding:
    """Return what is likely a mistake."""
    return Finding(DOUBT, holds, came, remedy)


def note(came: str, remedy: str) -> Finding:
    """Return what is worth knowing."""
    return Finding(NOTE, "", came, remedy)


class RefusedModel(ValueError):
    """No sensible result is possible with this model; the message lists every reason.

    Attributes
    ----------
    findings : tuple of Finding
        The refusals.
    """

    def __init__(self, findings: Sequence[Finding]) -> None:
        self.findings = tuple(findings)
        lines = [f"{finding}" for finding in self.findings]
        if all(finding.forcible for finding in self.findings):
            lines.append("to run it anyway: force=True, on the command line --force")
        super().__init__("\n".join(lines))
