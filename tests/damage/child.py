"""Runs the program as a child with limits and measures what it took."""
import argparse
import dataclasses
import json
import os
import pathlib
import resource
import signal
import subprocess
import tempfile
import time


@dataclasses.dataclass
class Done:
    code: int  # as of subprocess: below 0 where a signal ended it
    seconds: float
    cpu_seconds: float  # its own and that of the helpers it waited for
    peak_bytes: int  # resident; of the program or of one of its helpers, whichever is larger
    timed_out: bool
    out: str
    err: str

    @property
    def err_lines(self):
        return [line for line in self.err.splitlines() if line.strip()]


def start(command, address_space=None, **options):
    """A process in a group of its own."""
    def limit():
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if address_space:
            resource.setrlimit(resource.RLIMIT_AS, (address_space, address_space))
    return subprocess.Popen([str(c) for c in command], preexec_fn=limit, start_new_session=True, stdin=subprocess.DEVNULL, **options)


def wait(process, seconds):
    """(wait status, usage), or None where it still runs after so long."""
    until = time.monotonic() + seconds
    pause = 0.001
    while True:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            process.returncode = os.waitstatus_to_exitcode(status)
            return status, usage
        if time.monotonic() > until:
            return None
        time.sleep(pause)
        pause = min(2 * pause, 0.02)


def run(command, seconds=120.0, address_space=None, **options):
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        begin = time.monotonic()
        process = start(command, address_space, **{"stdout": out, "stderr": err, **options})
        ended = wait(process, seconds)
        timed_out = ended is None
        if timed_out:
            os.killpg(process.pid, signal.SIGKILL)
            ended = wait(process, 60)
        _, usage = ended
        taken = time.monotonic() - begin
        texts = []
        for stream in (out, err):
            stream.seek(0)
            texts.append(stream.read().decode(errors="replace"))
        return Done(process.returncode, taken, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024, timed_out, *texts)


def contents(folder, but=()):
    """Relative name -> bytes of every file below a folder (folders: None), without those named in `but` and what is below them."""
    folder = pathlib.Path(folder)
    found = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder)
        if name.parts[0] not in but:
            found[str(name)] = path.read_bytes() if path.is_file() else None
    return found


def must(command, **options):
    done = run(command, **options)
    if done.code != 0:
        raise SystemExit(f"{' '.join(map(str, command))} ended with {done.code}: {done.err}")
    return done


def random_trials(usage, count):
    """The arguments that programs of many random trials share; more can be added to it before trials() reads them."""
    parser = argparse.ArgumentParser(usage=usage)
    parser.add_argument("limn", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--count", type=int, default=count)
    parser.add_argument("--seed", type=int, default=None)
    parser.add_argument("--json", type=pathlib.Path)
    return parser


def trials(parser):
    """What was asked for, with a seed, printed, whatever happens next."""
    options = parser.parse_args()
    options.limn, options.folder = options.limn.resolve(), options.folder.resolve()
    if options.seed is None:
        options.seed = int.from_bytes(os.urandom(4), "little")
    print(f"seed {options.seed}", flush=True)
    return options


def report(options, name, tallies):
    """Writes the JSON where it was asked for; returns the exit code."""
    if options.json:
        options.json.write_text(json.dumps({"seed": options.seed, name: [t.record() for t in tallies]}, indent=1) + "\n")
    return 1 if any(t.failures for t in tallies) else 0
