#!/usr/bin/env python3
"""Every command and option that `--help` shows is in the man pages and in the completion of each shell; other programs read them without
complaint, and bash and fish complete what they should. What is not installed is skipped, and said.

manual.py LIMN FOLDER
"""
import pathlib
import re
import shutil
import subprocess
import sys

FAILURES = []


def check(fine, text):
    if not fine:
        FAILURES.append(text)
        print(f"wrong: {text}")


def run(*command, **options):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=120, **options)


def output(*command):
    done = run(*command)
    check(done.returncode == 0 and not done.stderr, f"{command}: exit code {done.returncode}, {done.stderr}")
    return done.stdout


def commands_of(help_text):
    return re.findall(r"^  ([a-z]+)\s", help_text.split("Subcommands:")[1].split("\n\n")[0], re.M)


def flags_of(help_text):
    heads = re.findall(r"^  (-[^\s]+)", help_text, re.M)
    return [flag for head in heads for flag in head.split(",")]


def values_of(limn, kind):
    return set(re.findall(r"^(\S+)", output(limn, "list", kind), re.M))


def check_man(limn, folder, flags):
    for page in [folder / "limn.1", *(folder / f"limn-{command}.1" for command in flags)]:
        text = page.read_text()
        if shutil.which("mandoc"):
            lint = run("mandoc", "-T", "lint", "-W", "warning", page)
            check(lint.returncode == 0, f"mandoc of {page.name}: {lint.stdout}")
        if shutil.which("man"):
            shown = run("man", "--warnings", "-l", page, env={"MANWIDTH": "80", "PATH": "/usr/bin:/bin", "LC_ALL": "C.UTF-8"})
            check(shown.returncode == 0 and not shown.stderr and "NAME" in shown.stdout, f"man of {page.name}: {shown.stderr}")
        if page.name != "limn.1":
            command = page.stem.removeprefix("limn-")
            check(text == output(limn, "man", command), f"limn man {command} prints another page than it writes")
            for flag in flags[command]:
                check(f"\\fB{flag}".replace("-", "\\-") in text, f"{page.name} lacks {flag}")
    whole = (folder / "limn.1").read_text()
    for command in flags:
        check(f"\\fB{command}\\fR" in whole, f"limn.1 lacks the command {command}")
        check(f".BR limn\\-{command} (1)" in whole, f"limn.1 does not refer to {command}")


def bash(script, *words):
    quoted = " ".join("'" + word + "'" for word in words)
    done = run("bash", "-c", f"source {script}; COMP_WORDS=({quoted}); COMP_CWORD={len(words) - 1}; _limn; printf '%s\\n' \"${{COMPREPLY[@]}}\"",
               cwd=script.parent)
    check(not done.stderr, f"bash completing {words}: {done.stderr}")
    return set(done.stdout.split())


def check_bash(limn, folder, flags):
    script = folder / "limn.bash"
    script.write_text(output(limn, "completion", "bash"))
    check(run("bash", "-n", script).returncode == 0, "bash cannot parse its completion")
    methods, scenes = values_of(limn, "methods"), values_of(limn, "scenes")
    check(bash(script, "limn", "") == {*flags, "-h", "--help", "--version"}, "bash completes other commands than there are")
    check(bash(script, "limn", "re") == {"render"}, "bash does not complete 're'")
    for command, known in flags.items():
        check(bash(script, "limn", command, "-") == set(known), f"bash completes other options of {command} than its help shows")
    check(bash(script, "limn", "render", "--method", "") == methods, "bash does not complete --method with all methods")
    check(bash(script, "limn", "render", "--method", "=", "fr") == {"fresnel"}, "bash does not complete --method=fr")
    check(bash(script, "limn", "compare", "--methods", "rim,fr") == {"rim,fresnel"}, "bash does not complete a list")
    check(scenes <= bash(script, "limn", "render", ""), "bash does not complete scenes")
    check("limn.bash" in bash(script, "limn", "render", ""), "bash does not complete files")
    check("limn.bash" in bash(script, "limn", "render", "-o", ""), "bash does not complete the output")
    check(bash(script, "limn", "render", "--size", "") == set(), "bash completes a size")
    check(bash(script, "limn", "completion", "") == {"bash", "zsh", "fish"}, "bash does not complete shells")


def check_zsh(limn, folder, flags):
    script = folder / "_limn"
    script.write_text(output(limn, "completion", "zsh"))
    text = script.read_text()
    for command, known in flags.items():
        part = text.split(f"    {command})\n")[1].split(";;")[0]
        for flag in known:
            check(re.search(rf"'\*{flag}[=+]?\[", part), f"zsh's completion of {command} lacks {flag}")
    if not shutil.which("zsh"):
        return print("skipped: no zsh; the package zsh brings it")
    check(run("zsh", "-n", script).returncode == 0, "zsh cannot parse its completion")
    loaded = run("zsh", "-fc", f"fpath=({folder} $fpath); autoload -U compinit; compinit -u -D; print $_comps[limn]; autoload +X _limn")
    check(loaded.stdout.strip() == "_limn" and loaded.returncode == 0, f"zsh does not load its completion: {loaded.stderr}")


def check_fish(limn, folder, flags):
    script = folder / "limn.fish"
    script.write_text(output(limn, "completion", "fish"))
    text = script.read_text()
    for command, known in flags.items():
        lines = "\n".join(line for line in text.splitlines() if f"_from {command}'" in line)
        for flag in known:
            check(re.search(rf" {'-l' if flag.startswith('--') else '-s'} {flag.lstrip('-')}( |$)", lines, re.M), f"fish's completion of {command} lacks {flag}")
    if not shutil.which("fish"):
        return print("skipped: no fish; the package fish brings it")

    def complete(call):
        done = run("fish", "-N", "-c", f"source {script}; complete -C '{call}'", cwd=folder)
        check(not done.stderr, f"fish completing '{call}': {done.stderr}")
        return {line.split("\t")[0] for line in done.stdout.splitlines()}

    check(run("fish", "-n", script).returncode == 0, "fish cannot parse its completion")
    check(set(flags) == complete("limn "), "fish completes other commands than there are")
    check(values_of(limn, "methods") == complete("limn render --method "), "fish does not complete --method with all methods")
    check("rim,fresnel" in complete("limn compare --methods rim,"), "fish does not complete a list")
    check(values_of(limn, "scenes") <= complete("limn render "), "fish does not complete scenes")
    for command, known in flags.items():
        check({flag for flag in known if flag.startswith("--")} <= complete(f"limn {command} --"), f"fish completes too few options of {command}")


def main():
    limn, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    flags = {command: flags_of(output(limn, command, "--help")) for command in commands_of(output(limn, "--help"))}
    check(len(flags) > 10 and all(len(known) >= 1 for known in flags.values()), "the help shows too few commands or options")
    check(run(limn, "man", "-o", folder).returncode == 0, "limn man -o fails")
    check_man(limn, folder, flags)
    check_bash(limn, folder, flags)
    check_zsh(limn, folder, flags)
    check_fish(limn, folder, flags)
    for call in (["man", "rendr"], ["completion", "tcsh"]):
        refused = run(limn, *call)
        check(refused.returncode == 2 and call[1] in refused.stderr, f"limn {' '.join(call)} is not refused: {refused.stderr}")
    print(f"{len(flags)} commands, {sum(map(len, flags.values()))} options: {len(FAILURES)} failures")
    sys.exit(1 if FAILURES else 0)


if __name__ == "__main__":
    main()
