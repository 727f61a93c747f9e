#!/usr/bin/env python3
"""Every call of limn in the README and in docs/ runs and ends as the page says; every link leads somewhere.

check.py LIMN FOLDER [--all] [--whole] [--json FILE]

Pictures are made small and models coarse where that keeps what a call means; --whole runs every call as it stands. Without --all the calls
that take long are left out (studies, plans, the demo, matrices of methods, frames), and said.
"""
import argparse
import concurrent.futures
import json
import pathlib
import re
import shutil
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "docs" / "site"))
import examples  # noqa: E402

FAILURES = []
# Calls whose answer is bad, as their page says: one part of eight is there; whether a drawing of the reader's own passes is not the page's to say.
ENDS = {"limn merge study": {1}, "limn judge screenshot.png": {0, 1}}
SIZED = ("render", "compare", "study", "contours", "plan")


def check(fine, text):
    if not fine:
        FAILURES.append(text)
        print(f"wrong: {text}", flush=True)


def takes_long(call):
    words = call.words
    return (call.command in ("study", "merge", "demo", "plan") or "all" in words or "--frames" in words or "--turntable" in words or "--tolerance" in words
            or (call.command in ("stability", "compare") and "--case" not in words))


def replaced(text, option, value):
    return re.sub(rf"({option}) \S+", rf"\1 {value}", text)


def reduced(call):
    """The same call, small. What ends with an error is as small as it gets."""
    text = call.text
    if call.message:
        return text
    if call.command in SIZED and "--size" not in text:
        text += " --size 96x72"
    if call.command == "contours" and "--surface level_set" in text:
        text = replaced(text, "--voxels", "48")
    text = re.sub(r"--voxels (\d+)\b(?!\.)", lambda found: f"--voxels {min(int(found[1]), 64)}", text)
    text = replaced(replaced(replaced(text, "--frames", "3"), "--turn", "1"), "--turntable", "3")
    if call.command == "compare" and "--voxels" not in text and not re.search(r"--surface (mesh|analytic)\b", text):
        text += " --voxels 48"
    if call.command == "study":
        text = re.sub(r"\s--(levels|voxels|views|thresholds) \S+", "", text) + " --levels 0,1 --voxels 16 --views 1"
    if call.command == "plan":
        text = replaced(text, "--views", "2")
    if call.command == "stability":
        text += "" if "--case" in text else " --case cube_faces"
        text += " --draws 1"
    if call.command == "demo":
        text += " --size 48x36"
    return text


def run_page(page, calls, limn, folder, options):
    shutil.copytree(folder / "files", folder / page)
    done = []
    for call in calls:
        if not options.all and takes_long(call):
            done.append((call, None, 0.0))
            continue
        start = time.monotonic()
        done.append((call, examples.run(call, limn, folder / page, call.text if options.whole else reduced(call), 3600), time.monotonic() - start))
    return done


def judge(call, result):
    where = f"{call.page}:{call.line}: {call.text}"
    if call.message:
        check(result.returncode == 2, f"{where}: ends with {result.returncode}, the page shows an error")
        # Estimates of memory differ from machine to machine in their last digits.
        shape = lambda text: re.sub(r"[\d.]+", "#", text)
        check(shape(result.stderr.splitlines()[0] if result.stderr else "") == shape(call.message), f"{where}: prints {result.stderr!r}, the page {call.message!r}")
        return
    expected = next((codes for start, codes in ENDS.items() if call.text.startswith(start)), {0})
    check(result.returncode in expected, f"{where}: ends with {result.returncode}: {result.stderr[-500:]}")


def check_calls(limn, folder, options):
    commands = examples.commands_of(limn)
    pages = {}
    for file in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]:
        calls = examples.calls_of(file, commands)
        if calls:
            pages[file.name] = calls
    check(sum(map(len, pages.values())) >= 60, "the pages show too few calls: they are not found")
    shown = {call.command for calls in pages.values() for call in calls}
    check(commands <= shown, f"no page shows a call of {sorted(commands - shown)}")
    examples.make_files(limn, ROOT, folder / "files")
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        results = list(pool.map(lambda page: run_page(page, pages[page], limn, folder, options), pages))
    ran, left_out = 0, []
    for call, result, _ in (one for done in results for one in done):
        if result is None:
            left_out.append(call)
            continue
        ran += 1
        judge(call, result)
    slowest = max((one for done in results for one in done), key=lambda one: one[2])
    print(f"{ran} calls of {len(pages)} pages run, {len(left_out)} left out; the slowest took {slowest[2]:.1f} s: {slowest[0].text}", flush=True)
    return {"calls": ran, "left_out": len(left_out)}


def slug(heading):
    """As GitHub and mkdocs name a heading's anchor."""
    return re.sub(r"\s", "-", re.sub(r"[^\w\s-]", "", heading.replace("`", "")).strip().lower())


def anchors(file):
    return {slug(line.lstrip("#")) for line in file.read_text().splitlines() if line.startswith("#")}


def check_links():
    number = 0
    for file in [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")]:
        for target in re.findall(r"\]\(([^)\s]+)\)", file.read_text()):
            if re.match(r"[a-z]+:", target):
                continue
            number += 1
            path, _, anchor = target.partition("#")
            linked = (file.parent / path).resolve() if path else file
            check(linked.exists(), f"{file.name} links to {target}, which is not there")
            if anchor and linked.suffix == ".md" and linked.exists():
                check(anchor in anchors(linked), f"{file.name} links to {target}, which has no such heading")
    print(f"{number} links of pages lead somewhere", flush=True)
    return number


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("limn", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--whole", action="store_true")
    parser.add_argument("--json", type=pathlib.Path)
    options = parser.parse_args()
    folder, limn = options.folder.resolve(), options.limn.resolve()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    figures = {"links": check_links()} | check_calls(limn, folder, options)
    if options.json:
        options.json.write_text(json.dumps({"figures": figures, "failures": FAILURES}, indent=1) + "\n")
    print(f"{len(FAILURES)} failures")
    sys.exit(1 if FAILURES else 0)


if __name__ == "__main__":
    main()
