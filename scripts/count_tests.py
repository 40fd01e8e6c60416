#!/usr/bin/env python3
"""Count test cases in a CTest JUnit report: prints "PASSED FAILED SKIPPED" and, on standard error, what failed and why.

A cmocka program counts as its test cases, any other test as one. A program that failed without a failed case (it
crashed, ran out of time, or a sanitizer spoke) adds one failure.
"""

import re
import sys
import xml.etree.ElementTree

CASES = {kind: re.compile(r"^\[ *%s *\] (\d+) test\(s\)" % kind, re.MULTILINE)
         for kind in ("PASSED", "FAILED", "SKIPPED")}


LINES_OF_A_FAILURE = 80


def output_of(case):
    return "".join(element.text or "" for element in case.iter("system-out"))


def count(case):
    output = output_of(case)
    passed, failed, skipped = (sum(int(n) for n in CASES[kind].findall(output))
                               for kind in ("PASSED", "FAILED", "SKIPPED"))
    status = case.get("status")
    if status in ("notrun", "disabled"):
        return 0, 0, 1
    if status != "run" and failed == 0:
        failed = 1
    if passed + failed + skipped == 0:
        passed = 1
    return passed, failed, skipped


def main():
    totals = [0, 0, 0]
    for case in xml.etree.ElementTree.parse(sys.argv[1]).getroot().iter("testcase"):
        counts = count(case)
        totals = [a + b for a, b in zip(totals, counts)]
        if counts[1]:
            print(f"  failed: {case.get('name')}", file=sys.stderr)
            for line in output_of(case).splitlines()[-LINES_OF_A_FAILURE:]:
                print("    " + line, file=sys.stderr)
        if counts[2]:
            print(f"  skipped: {case.get('name')} ({counts[2]})", file=sys.stderr)
    print(*totals)


if __name__ == "__main__":
    main()
