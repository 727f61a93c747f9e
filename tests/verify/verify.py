#!/usr/bin/env python3
"""One command with the table: everything that shows where limn holds and where it fails, each part a JSON, then one table of them all.

verify.py [--quick] [--again] [--only PART]... [--report] [--limn PROGRAM] [--out FOLDER] [--markdown FILE]

PARTs: stability, mutants, kills, determinism, seeds, fuzz, asan, tsan, scalar, coverage, packages, docs. Each writes FOLDER/<part>.json (limn-out/verify/...) with its
outcome, figures and failures, and its output to FOLDER/<part>.log. --report makes only the table, from what is there; a part that never ran is
"not run". --again runs, of the suites under asan, tsan and scalar, only the tests that failed the last time. --quick tries fewer of everything
and leaves out the parts that build limn anew. Ends with 1 where a part failed.
"""
import argparse
import pathlib
import sys

import parts
import table

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


def report(out):
    """Writes the table of what is there, as Markdown and as a page; gives the records and the Markdown."""
    records = parts.read_all(out)
    markdown = table.markdown(records)
    (out / "table.md").write_text(markdown)
    (out / "index.html").write_text(table.page(records))
    return records, markdown


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--only", action="append", choices=parts.NAMES)
    parser.add_argument("--report", action="store_true")
    parser.add_argument("--limn", type=pathlib.Path, default=ROOT / "build" / "release" / "limn")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "limn-out" / "verify")
    parser.add_argument("--markdown", type=pathlib.Path, help="write the Markdown there too")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    chosen = [] if options.report else options.only or [n for n in parts.NAMES if not (options.quick and n in parts.BUILDING)]
    for name in chosen:
        print(f"{name} …", flush=True)
        record = parts.run(name, options.limn.resolve(), options.out.resolve(), options.quick, options.again)
        print(f"{name}: {record['outcome']}, {record['seconds']:.0f} s" + "".join(f"\n  {f}" for f in record["failures"][:10]), flush=True)
        report(options.out)  # whoever ends this early has the table so far
    records, markdown = report(options.out)
    if options.markdown:
        options.markdown.write_text(markdown)
    print("\n" + markdown + f"\n{options.out / 'index.html'}")
    return 1 if any(r["outcome"] == "failed" for r in records.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
