"""Run the verification cases: python tests/verification/run.py [--case ID] [--json FILE].

Prints a table of every number against its reference and exits with 1 if a gate fails.
"""

import argparse
import sys
import traceback
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from harness import as_json, load_cases, run_case


def row(result, k):
    check = result.checks[k]
    verdict = ("pass" if check.passed else "FAIL") if check.gate else "info"
    unit = "" if check.absolute else " %"
    scale = 1.0 if check.absolute else 100.0
    return (
        f"{result.id:<5} {check.quantity:<58} {check.reference:>12.6g} {check.ours:>12.6g} "
        f"{scale * check.error:>+10.3g}{unit:<2} {scale * check.band:>8.3g}{unit:<2} {verdict}"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--case", help="run one case only, e.g. A03")
    parser.add_argument("--json", type=Path, help="write the table to this file")
    parser.add_argument("--fast", action="store_true", help="only the cases that pytest runs")
    options = parser.parse_args()
    head = f"{'case':<5} {'quantity':<58} {'reference':>12} {'ours':>12} {'error':>12}"
    head += f" {'tolerance':>10}"
    print(head, "verdict", flush=True)
    results, failed = [], []
    for case in load_cases(options.case, fast_only=options.fast):
        try:
            result = run_case(case)
        except Exception:  # the others are still to be told
            traceback.print_exc()
            print(f"{case.ID:<5} did not end: FAIL", flush=True)
            failed.append(case.ID)
            continue
        results.append(result)
        for k in range(len(result.checks)):
            print(row(result, k), flush=True)
    failed += [result.id for result in results if not result.passed]
    gates = sum(check.gate for result in results for check in result.checks)
    seconds = sum(result.seconds for result in results)
    print(
        f"{len(results)} cases ended, {gates} gates, "
        + (f"FAILED: {', '.join(failed)}" if failed else "all pass")
        + f", {seconds:.0f} s"
    )
    if options.json is not None:
        options.json.write_text(as_json(results))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
