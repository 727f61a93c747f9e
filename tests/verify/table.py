"""The table of what was verified, as Markdown and as a page of its own."""
import html

TITLES = {
    "stability": "Cases where methods fail",
    "mutants": "Damaged files",
    "kills": "Kills, full disks, closed streams",
    "determinism": "Equal calls, equal bytes",
    "seeds": "Random tests, other seeds",
    "fuzz": "Fuzzers",
    "asan": "Suite, address and undefined behaviour",
    "tsan": "Suite, threads",
    "scalar": "Suite, SIMD off",
    "coverage": "Own code reached by the suite",
    "packages": "Packages in a bare Debian",
    "docs": "Calls and links of the documentation",
}


def listed(counts):
    return ", ".join(f"{number} {what}" for what, number in counts.items() if number)


def words_of(name, figures):
    """The figures of a part as one sentence."""
    f = figures
    if not f:
        return ""
    if name == "stability":
        counts = {k.replace("_", " "): v for k, v in f.items() if k not in ("cases", "cells")}
        return f"{f['cases']} cases, {f['cells']} cells: {listed(counts)}"
    if name == "mutants":
        guarded = f", of these {sum(f['reader_ended_by'].values())} where the reader had to be ended ({listed(f['reader_ended_by'])})" \
            if f["reader_ended_by"] else ""
        lost = f", {f['incomplete']} parts merged with cells missing" if f["incomplete"] else ""
        return (f"{f['tried']} tried: {f['read']} read, {f['refused']} refused with file and reason{guarded}{lost}; "
                f"slowest {f['slowest_s']:.1f} s, most memory {f['peak_mb']} MB; {f['wrong']} wrong")
    if name == "kills":
        skipped = [p["name"] for p in f["parts"] if p["skipped"]]
        return f"{f['tried']} tried, {f['tried'] - f['wrong']} survived, {f['wrong']} wrong" + (f"; skipped: {', '.join(skipped)}" if skipped else "")
    if name == "determinism":
        return f"{f['files']} files of {'the demo' if f['demo'] else 'some calls'}, {f['runs']} runs with 1 and 2 threads: {f['differing']} differ"
    if name == "seeds":
        return f"{f['tests']} tests, {f['runs']:,} runs from seed {f['first_seed']}: {f['failed']} failed"
    if name == "fuzz":
        return f"{f['fuzzers']} fuzzers, {f['seconds_each']} s each: {f['executions']:,} runs, {f['crashes']} crashes"
    if name == "coverage":
        return f"{f['lines_percent']:.1f} % of lines, {f['branches_percent']:.1f} % of branches"
    if name == "packages":
        return (f"lintian finds {f['lintian_errors']} errors; installed in {f['install_s']:.0f} s, demo in {f['demo_s']:.0f} s, "
                f"{f['files_left']} files left after the purge")
    if name == "docs":
        return f"{f['calls']} calls run, {f['left_out']} left out, {f['links']} links followed"
    again = f"; {f['ran_again']} of them ran again after a change" if f.get("ran_again") else ""
    return f"{f['tests']} tests, {f['failed']} failed, {f['skipped']} skipped, {f['left_out']} left out{again}"


def rows(records):
    for name, title in TITLES.items():
        record = records[name]
        outcome = record["outcome"] + (" (quick)" if record["quick"] else "")
        yield title, outcome, words_of(name, record["figures"]), record


def markdown(records):
    lines = ["| what | outcome | figures | revision |", "|---|---|---|---|"]
    lines += [f"| {title} | {outcome} | {words or '–'} | {record['commit'] or '–'} |" for title, outcome, words, record in rows(records)]
    return "\n".join(lines) + "\n"


def details(head, body):
    cells = "".join(f"<th>{html.escape(h)}</th>" for h in head)
    lines = "".join("<tr>" + "".join(f"<td>{html.escape(str(c))}</td>" for c in row) + "</tr>" for row in body)
    return f"<div class=wide><table><thead><tr>{cells}</tr></thead><tbody>{lines}</tbody></table></div>"


def mutants_html(figures):
    return details(("kind", "tried", "read", "refused", "reader ended by", "wrong"),
                   [(k["kind"], k["tried"], k["read"] + k["incomplete"], k["refused"], listed(k["reader_ended_by"]) or "–", k["wrong"])
                    for k in figures["kinds"]])


def kills_html(figures):
    return details(("what", "tried", "what happened", "wrong"),
                   [(p["name"].replace("_", " "), p["tried"], p["skipped"] or listed(p["outcomes"]), p["wrong"]) for p in figures["parts"]])


STYLE = """:root{color-scheme:light dark;--line:#8886}body{font:16px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem}
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}th,td{text-align:left;vertical-align:top;padding:.4rem .6rem;
border-bottom:1px solid var(--line)}.wide{overflow-x:auto}.held::before{content:"✓ "}.failed::before{content:"✗ "}.failed{font-weight:700}
@media(max-width:40rem){table.main thead{display:none}table.main tr,table.main td{display:block;border:0;padding:.1rem 0}
table.main tr{border-bottom:1px solid var(--line);padding:.6rem 0}table.main td:first-child{font-weight:600}}"""


def page(records):
    body = ""
    for title, outcome, words, record in rows(records):
        mark = record["outcome"] if record["outcome"] in ("held", "failed") else "none"
        body += f'<tr><td>{html.escape(title)}</td><td class="{mark}">{html.escape(outcome)}</td><td>{html.escape(words or "–")}</td>' \
                f'<td>{html.escape(record["commit"] or "–")}</td></tr>'
    text = ("<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width,initial-scale=1'>"
            f"<title>limn: what was verified</title><style>{STYLE}</style><h1>What was verified, and what came out</h1>"
            f"<table class=main><thead><tr><th>what</th><th>outcome</th><th>figures</th><th>revision</th></tr></thead><tbody>{body}</tbody></table>")
    for name, make in (("mutants", mutants_html), ("kills", kills_html)):
        if records[name]["figures"]:
            text += f"<h2>{TITLES[name]}</h2>" + make(records[name]["figures"])
    for name, record in records.items():
        if record["failures"]:
            items = "".join(f"<li>{html.escape(f)}</li>" for f in record["failures"][:50])
            text += f"<h2>Failed: {html.escape(TITLES[name])}</h2><ul>{items}</ul>"
    return text + "</html>\n"
