"""Looks for known vulnerabilities of the tested versions: `python -m tools.audit`.

`pip-audit` asks the database of PyPI, and that of OSV where the first does not answer. Without a
network the audit is skipped in a sentence, since a missing answer is no fault of the code. The exit
code is 1 if a vulnerability is known.
"""

import json
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]

SERVICES = ("pypi", "osv")
"""Databases, in the order in which they are asked."""


class Finding(NamedTuple):
    """A known vulnerability: of which release, its identifier, and the releases without it."""

    package: str
    identifier: str
    fixed: tuple[str, ...]

    def describe(self) -> str:
        """Say what it is, and what to do."""
        remedy = f"raise it to {' or '.join(self.fixed)}" if self.fixed else "there is no mend yet"
        return f"{self.package} has {self.identifier}: {remedy}."


class Audit(NamedTuple):
    """What a database knows: vulnerabilities, and how many packages it knows and does not know."""

    findings: tuple[Finding, ...]
    known: int
    unknown: int


def main() -> int:
    """Audit the versions of constraints.txt."""
    for service in SERVICES:
        audit = ask(service, ROOT / "constraints.txt")
        if audit is not None and audit.known:
            return _report(audit, service)
    print("audit: Skipped, since no database of vulnerabilities answers from here.")
    return 0


def ask(service: str, constraints: Path) -> Audit | None:
    """Ask a database for the vulnerabilities of pinned versions.

    Args:
        service: The name that pip-audit has for it.
        constraints: A file with one NAME==VERSION a line.

    Returns:
        What it knows; None if it does not answer.
    """
    flags = ("--no-deps", "--disable-pip", "--progress-spinner=off", "--timeout=10", "-f", "json")
    command = [sys.executable, "-m", "pip_audit", "-s", service, *flags, "-r", str(constraints)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=600)
        return parse(json.loads(done.stdout)["dependencies"])
    except (subprocess.TimeoutExpired, ValueError, KeyError, TypeError):
        return None


def parse(dependencies: Sequence[dict[str, object]]) -> Audit:
    """Parse what pip-audit says of each package."""
    known = [each for each in dependencies if "skip_reason" not in each]
    findings = tuple(
        Finding(f"{each['name']} {each['version']}", one["id"], tuple(one["fix_versions"]))
        for each in known
        for one in each.get("vulns", ())  # type: ignore[attr-defined]
    )
    return Audit(findings, len(known), len(dependencies) - len(known))


def _report(audit: Audit, service: str) -> int:
    for finding in audit.findings:
        print(f"audit: {finding.describe()}", file=sys.stderr)
    skipped = f"; {audit.unknown} are not in it" if audit.unknown else ""
    print(
        f"audit: {service} knows {audit.known} packages, {len(audit.findings)} "
        f"vulnerabilities{skipped}."
    )
    return int(bool(audit.findings))


if __name__ == "__main__":
    sys.exit(main())
