#!/usr/bin/env python3
"""A study in shards on a real Slurm, started on loopback for this test alone: one task is killed, and the merged rows are still those of a run
in one process.

    slurm_test.py LIMN WORKFLOW_FOLDER

Needs root, snakemake, munged, slurmctld, slurmd and their clients; without them it says so and exits with 77."""
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

# Long enough that a task can be killed between its first rows, which are written once a second, and its last.
STUDY = ["--size", "160x120", "--levels", "0..3", "--voxels", "16,32", "--views", "8"]
SHARDS = 3


def skip(why):
    print(f"skipped: {why}")
    sys.exit(77)


def find_tools():
    if os.geteuid() != 0:
        skip("only root can start slurmd")
    os.environ["PATH"] += ":/usr/sbin:/sbin"
    packages = {"munged": "munge", "slurmctld": "slurmctld", "slurmd": "slurmd", "sbatch": "slurm-client", "snakemake": "snakemake"}
    for tool, package in packages.items():
        if shutil.which(tool) is None:
            skip(f"no {tool}; the package {package} brings it")


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def wait_for(what, test, seconds, processes=()):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        for process in processes:
            if process.poll() is not None:
                raise RuntimeError(f"{process.args[0]} ended with {process.returncode} while waiting for {what}")
        result = test()
        if result:
            return result
        time.sleep(0.05)
    raise RuntimeError(f"no {what} after {seconds} s")


class Cluster:
    """munged, slurmctld and slurmd, each in the foreground, everything they write below one folder."""

    def __init__(self, folder):
        self.folder = folder
        self.host = socket.gethostname().split(".")[0]
        self.processes = []

    def start(self, name, arguments):
        log = open(self.folder / f"{name}.out", "wb")
        process = subprocess.Popen(arguments, stdout=log, stderr=log, stdin=subprocess.DEVNULL, start_new_session=True)
        self.processes.append(process)
        return process

    def __enter__(self):
        try:
            self.boot()
        except BaseException:
            self.__exit__()
            raise
        return self

    def boot(self):
        begin = time.monotonic()
        key, munge_socket = self.folder / "munge.key", self.folder / "munge.socket"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        munged = self.start("munged", ["munged", "--foreground", "--force", f"--key-file={key}", f"--socket={munge_socket}",
                                       f"--pid-file={self.folder}/munged.pid", f"--log-file={self.folder}/munged.log",
                                       f"--seed-file={self.folder}/munged.seed"])
        wait_for("munge socket", munge_socket.exists, 10, [munged])
        self.write_configuration(munge_socket)
        os.environ["SLURM_CONF"] = str(self.folder / "slurm.conf")
        slurmctld = self.start("slurmctld", ["slurmctld", "-D", "-c"])
        slurmd = self.start("slurmd", ["slurmd", "-D", "-N", self.host])
        wait_for("idle node", self.is_idle, 30, [slurmctld, slurmd])
        print(f"Slurm was ready in {time.monotonic() - begin:.1f} s")

    def is_idle(self):
        return subprocess.run(["sinfo", "-h", "-o", "%T"], capture_output=True, text=True).stdout.strip() == "idle"

    def write_configuration(self, munge_socket):
        for name in ("state", "spool"):
            (self.folder / name).mkdir()
        # Two at least, so that tasks run side by side even on the smallest machine.
        processors = max(2, os.cpu_count() or 1)
        (self.folder / "slurm.conf").write_text(f"""ClusterName=limn
SlurmctldHost={self.host}(127.0.0.1)
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
AuthType=auth/munge
AuthInfo=socket={munge_socket}
SlurmUser=root
SlurmdUser=root
StateSaveLocation={self.folder}/state
SlurmdSpoolDir={self.folder}/spool
SlurmctldPidFile={self.folder}/slurmctld.pid
SlurmdPidFile={self.folder}/slurmd.pid
SlurmctldLogFile={self.folder}/slurmctld.log
SlurmdLogFile={self.folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SwitchType=switch/none
ReturnToService=2
SlurmdParameters=config_overrides
KillWait=1
SchedulerParameters=batch_sched_delay=0,sched_min_interval=100000
NodeName={self.host} NodeAddr=127.0.0.1 CPUs={processors} RealMemory=8000 State=UNKNOWN
PartitionName=main Nodes={self.host} Default=YES MaxTime=INFINITE State=UP
""")

    def __exit__(self, *_):
        if "SLURM_CONF" in os.environ:
            subprocess.run(["scancel", "--signal=KILL", "--full", "--user=root"], capture_output=True, timeout=20)
        for process in reversed(self.processes):
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
                try:
                    process.wait(10)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()


def running_job(out):
    """A job whose shard has rows already, so that there is something to go on from."""
    jobs = subprocess.run(["squeue", "-h", "-t", "RUNNING", "-o", "%i"], capture_output=True, text=True).stdout.split()
    begun = [rows for rows in out.glob("part-*.unfinished/rows.jsonl") if rows.stat().st_size > 0]
    return jobs[0] if jobs and begun else None


def run_workflow(limn, workflow, out, folder):
    """Runs the shards as jobs and kills one of them."""
    # Snakemake asks for the state of jobs every second, and not every ten, where CI says that there is no hurry to be polite.
    environment = dict(os.environ, CI="true", HOME=str(folder))
    command = ["snakemake", "-s", str(workflow / "Snakefile"), "--directory", str(folder), "-j", str(SHARDS), "--config", "input=ellipsoid",
               f"out={out}", f"shards={SHARDS}", f"limn={limn}", "threads=1", "mem_mb=500", f"options={' '.join(STUDY)}", "--cluster",
               "sbatch --parsable -c {threads} --mem {resources.mem_mb} -o /dev/null", "--cluster-status", str(workflow / "slurm-status"),
               "--latency-wait", "2"]
    with open(folder / "snakemake.out", "wb") as log:
        process = subprocess.Popen(command, env=environment, stdout=log, stderr=log, cwd=folder)
        try:
            job = wait_for("running task", lambda: running_job(out), 60, [process])
            subprocess.run(["scancel", "--signal=KILL", "--full", job], check=True)
            print(f"killed the task of job {job}")
            process.wait(120)
        finally:
            if process.poll() is None:
                process.kill()
                process.wait()
    text = (folder / "snakemake.out").read_text(errors="replace")
    if process.returncode != 0:
        raise RuntimeError(f"snakemake ended with {process.returncode}\n{text}")
    if "Trying to restart job" not in text:
        raise RuntimeError(f"no task was tried again\n{text}")


def timeless_rows(folder):
    rows = []
    for line in (folder / "rows.jsonl").read_text().splitlines():
        row = json.loads(line)
        for name in [name for name in row if name.endswith("_ms")]:
            row.pop(name)
        rows.append(row)
    return rows


def main():
    limn, workflow = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    find_tools()
    # Short, because the path of a socket may not be long.
    folder = pathlib.Path(tempfile.mkdtemp(prefix="limn-slurm-", dir="/tmp"))
    try:
        whole, out = folder / "whole", folder / "out"
        with Cluster(folder) as _:
            run_workflow(limn, workflow, out, folder)
        subprocess.run([limn, "study", "ellipsoid", *STUDY, "-o", whole, "-q"], check=True)
        merged, alone = timeless_rows(out), timeless_rows(whole)
        if merged != alone:
            raise RuntimeError(f"{len(merged)} merged rows differ from the {len(alone)} of one process")
        if not (out / "report.html").exists():
            raise RuntimeError("no report")
        print(f"{len(merged)} rows, the same as those of one process")
    except Exception:
        for log in sorted(folder.glob("*.log")) + sorted(folder.glob("*.out")):
            print(f"== {log.name}\n" + log.read_text(errors="replace")[-2000:])
        raise
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
