#!/usr/bin/env python3
"""The site: the pages of docs/ with the README as the first, pictures of the cookbook's calls, and Doxygen's reference beside them.

build.py LIMN FOLDER [--headers FOLDER]

FOLDER/index.html works from disk and requests nothing from anywhere. Fails where mkdocs warns, a call fails, or a page wants something of
another machine.
"""
import argparse
import pathlib
import re
import shutil
import subprocess
import sys

import examples

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
TITLES = (("index.md", "Overview"), ("start.md", "Start"), ("cookbook.md", "Cookbook"), ("methods.md", "Methods"), ("lines.md", "Lines"), ("accuracy.md", "Accuracy"),
          ("performance.md", "Performance"), ("growth.md", "Growth"), ("stability.md", "Stability"), ("files.md", "Files"), ("commands.md", "Commands"),
          ("reference.md", "Reference"), ("python.md", "Python"), ("cpp.md", "C++"), ("glossary.md", "Glossary"), ("ARCHITECTURE.md", "Architecture"),
          ("CONTRIBUTING.md", "Contributing"), ("CHANGELOG.md", "Changelog"))
SHOWN = (".png", ".svg")
CONFIG = """site_name: limn
site_url: ""
docs_dir: {source}
site_dir: {site}
use_directory_urls: false
extra_css: [site.css]
theme:
  name: material
  font: false
  features: [navigation.top, navigation.tracking]
  palette:
    - media: "(prefers-color-scheme: light)"
      scheme: default
      primary: blue grey
      toggle: {{icon: material/weather-night, name: dark}}
    - media: "(prefers-color-scheme: dark)"
      scheme: slate
      primary: blue grey
      toggle: {{icon: material/weather-sunny, name: light}}
plugins: [search]
markdown_extensions:
  - tables
  - fenced_code
  - toc:
      slugify: !!python/name:github_slug.slugify
nav:
{nav}
"""


def pages():
    """Name in the site -> file."""
    found = {"index.md": ROOT / "README.md"}
    for file in [*sorted((ROOT / "docs").glob("*.md")), *(ROOT / f"{name}.md" for name in ("ARCHITECTURE", "CONTRIBUTING", "CHANGELOG"))]:
        found[file.name] = file
    return found


def with_links(text, file, known, source):
    """Links to pages lead to the site's; other files of the repository come with it, and folders become plain text."""
    places = {path: name for name, path in known.items()}

    def place(match):
        mark, label, target = match[1], match[2], match[3]
        if re.match(r"[a-z]+:|#", target):
            return match[0]
        path, _, anchor = target.partition("#")
        linked = (file.parent / path).resolve()
        if linked in places:
            return f"{mark}[{label}]({places[linked]}{'#' + anchor if anchor else ''})"
        if not linked.is_file():
            return label
        copied = source / "files" / linked.relative_to(ROOT)
        copied.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(linked, copied)
        return f"{mark}[{label}](files/{linked.relative_to(ROOT)})"

    # A picture may be the label of a link; labels hold no other brackets.
    return re.sub(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s]+)\)", place, text)


def pictures_of(calls, folder, source):
    """For each task what its last call wrote, as far as a page can show it: Markdown."""
    shown = {}
    for call in calls:
        for name in call.outputs():
            file = folder / name / "sheet.png" if (folder / name).is_dir() else folder / name
            if file.suffix not in SHOWN or not file.exists():
                continue
            target = source / "cookbook" / (name.replace("/", "-") + ("" if file.suffix in name else file.suffix))
            target.parent.mkdir(exist_ok=True)
            shutil.copy(file, target)
            shown.setdefault(call.heading, []).append(f"![{call.heading}](cookbook/{target.name})")
    return shown


def cookbook(text, limn, work, source):
    folder = work / "calls"
    examples.make_files(limn, ROOT, folder)
    calls = examples.calls_of(ROOT / "docs" / "cookbook.md", examples.commands_of(limn))
    for number, call in enumerate(calls, 1):
        print(f"{number} of {len(calls)}: {call.text}", flush=True)
        done = examples.run(call, limn, folder)
        if done.returncode != 0:
            sys.exit(f"{call.page}:{call.line}: {call.text}: ends with {done.returncode}: {done.stderr}")
    shown = pictures_of(calls, folder, source)
    parts = re.split(r"(?m)^(### .*)$", text)
    for i in range(1, len(parts), 2):
        # Behind the calls of the task, and before what starts the next part.
        body, _, rest = parts[i + 1].partition("\n## ")
        parts[i + 1] = body.rstrip() + "\n\n" + "\n".join(shown.get(parts[i].lstrip("# "), [])) + "\n\n" + ("## " + rest if rest else "")
    return "".join(parts)


def check_no_requests(site):
    """Pages load nothing over the network; links to follow are another matter."""
    for page in site.glob("*.html"):
        for tag in re.findall(r"<(?:script|link|img|iframe)\b[^>]*>", page.read_text()):
            if re.search(r"(?:src|href)=\"?(?:https?:)?//", tag):
                sys.exit(f"{page.name} loads from another machine: {tag}")


def check_links(site):
    """Every link within the site leads to a file of it, and to a place in that file."""
    names, number = {}, 0
    for page in site.glob("*.html"):
        names[page.name] = set(re.findall(r'\b(?:id|name)="([^"]+)"', page.read_text()))
    for page in site.glob("*.html"):
        if page.name == "404.html":
            continue
        for link in re.findall(r'<(?:a|img|script|link)\b[^>]*?(?:href|src)="([^"]+)"', page.read_text()):
            path, _, anchor = link.partition("#")
            if re.match(r"[a-z]+:", path):
                continue
            number += 1
            if not (site / path).exists():
                sys.exit(f"{page.name} links to {link}, which is not there")
            linked = path or page.name
            if anchor and linked in names and anchor not in names[linked]:
                sys.exit(f"{page.name} links to {link}, which has no such place")
    print(f"{number} links of the site lead somewhere")


def add_search_from_disk(site):
    index = (site / "search" / "search_index.json").read_text()
    script = (HERE / "search_from_disk.js").read_text().replace("Promise.resolve(INDEX)", f"Promise.resolve({index})")
    (site / "search" / "from_disk.js").write_text(script)
    for page in site.glob("*.html"):
        text, number = re.subn(r'(<script src="[^"]*assets/javascripts/bundle)', r'<script src="search/from_disk.js"></script>\1', page.read_text())
        if number != 1 and page.name != "404.html":
            sys.exit(f"{page.name}: the theme's script is not where it was")
        page.write_text(text)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("limn", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--headers", type=pathlib.Path, help="Doxygen's pages, to stand beside it")
    options = parser.parse_args()
    site = options.folder.resolve()
    work = site.parent / (site.name + "-source")
    source = work / "pages"
    shutil.rmtree(work, ignore_errors=True)
    source.mkdir(parents=True)
    known = pages()
    for name, file in known.items():
        text = with_links(file.read_text(), file, known, source)
        (source / name).write_text(cookbook(text, options.limn.resolve(), work, source) if name == "cookbook.md" else text)
    if options.headers:
        with open(source / "cpp.md", "a") as stream:
            stream.write('\n<a href="headers/index.html">The reference of the headers</a>\n')
    shutil.copy(HERE / "site.css", source)
    nav = "\n".join(f"  - {title}: {name}" for name, title in TITLES if name in known)
    (work / "mkdocs.yml").write_text(CONFIG.format(source=source, site=site, nav=nav))
    environment = {"PYTHONPATH": str(HERE), "PATH": "/usr/bin:/bin", "HOME": str(work), "LC_ALL": "C.UTF-8"}
    done = subprocess.run(["mkdocs", "build", "--strict", "--clean", "-q", "-f", work / "mkdocs.yml"], env=environment)
    if done.returncode != 0:
        sys.exit("mkdocs failed")
    if options.headers:
        shutil.copytree(options.headers, site / "headers", ignore=shutil.ignore_patterns("generated"))
    add_search_from_disk(site)
    check_no_requests(site)
    check_links(site)
    print(site / "index.html")


if __name__ == "__main__":
    main()
