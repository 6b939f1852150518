"""A Slurm of its own on this machine: a controller and node daemons, everything on 127.0.0.1 and in one folder.

Needs root, and the packages of tools/install_deps.sh --cluster. Every process is ended by its id.
"""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

CONF = """\
ClusterName=weft
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CryptoType=crypto/munge
SlurmctldPort={ports[0]}
SlurmctldPidFile={folder}/slurmctld.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdPidFile={folder}/slurmd.%n.pid
SlurmdLogFile={folder}/slurmd.%n.log
SlurmdSpoolDir={folder}/spool.%n
StateSaveLocation={folder}/state
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SwitchType=switch/none
MpiDefault=none
SchedulerType=sched/backfill
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
JobRequeue=1
ReturnToService=2
SlurmdTimeout=10
KillWait=2
NodeName=n1 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs=1 RealMemory=2000 State=UNKNOWN
NodeName=n2 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs=1 RealMemory=2000 State=UNKNOWN
PartitionName=main Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
"""
LIMIT = 120  # for anything that has to happen at all [s]


def until(what: str, condition: Callable[[], bool]) -> None:
    end = time.monotonic() + LIMIT
    while not condition():
        if time.monotonic() > end:
            raise TimeoutError(f"{what} has not happened within {LIMIT} s")
        time.sleep(0.1)


def free_ports(count: int) -> list[int]:
    sockets = [socket.socket() for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


def parents() -> dict[int, int]:
    """Of all processes, by id."""
    found = {}
    for each in Path("/proc").iterdir():
        if each.name.isdigit():
            try:
                found[int(each.name)] = int((each / "stat").read_text().rpartition(")")[2].split()[1])
            except OSError:
                continue
    return found


def descendants(process: int) -> list[int]:
    found, family = [process], parents()
    for each in found:
        found += [child for child, parent in family.items() if parent == each]
    return found


def is_running(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


class Slurm:
    def __init__(self, folder: Path) -> None:
        self._folder, self._host = folder, socket.gethostname().split(".")[0]
        self.conf = folder / "slurm.conf"
        self._ours: dict[str, int] = {}  # process ids of daemons
        self._steps: set[int] = set()

    def __enter__(self) -> Slurm:
        try:
            self._start()
        except BaseException:
            self._stop()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self._stop()

    def _start(self) -> None:
        folder = self._folder
        os.environ["SLURM_CONF"] = str(self.conf)
        for name in ("state", "spool.n1", "spool.n2"):
            (folder / name).mkdir(mode=0o700)
        self.conf.write_text(CONF.format(host=self._host, folder=folder, ports=free_ports(3)))
        self._run("mungekey", "--create", f"--keyfile={folder}/munge.key")
        self._run(
            "munged", f"--socket={folder}/munge.socket", f"--key-file={folder}/munge.key", f"--pid-file={folder}/munge.pid",
            f"--log-file={folder}/munge.log", f"--seed-file={folder}/munge.seed", "--force",
        )  # fmt: skip
        self._ours["munged"] = self._process_id("munge.pid")
        self._run("slurmctld", "-f", str(self.conf))
        self._ours["slurmctld"] = self._process_id("slurmctld.pid")
        for node in ("n1", "n2"):
            self.start_node(node)
        for node in ("n1", "n2"):
            until(f"node {node} idle", lambda node=node: self.state(node) == "IDLE")  # type: ignore[misc]

    def _process_id(self, file: str) -> int:
        path = self._folder / file
        until(file, lambda: path.is_file() and path.read_text().strip() != "")
        return int(path.read_text())

    @staticmethod
    def _run(*command: str) -> str:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT)
        if done.returncode:
            raise RuntimeError(f"{' '.join(command)}: {done.stderr.strip()}")
        return done.stdout

    def start_node(self, node: str) -> None:
        (self._folder / f"slurmd.{node}.pid").unlink(missing_ok=True)
        self._run("slurmd", "-f", str(self.conf), "-N", node)
        self._ours[node] = self._process_id(f"slurmd.{node}.pid")

    def state(self, node: str) -> str:
        """IDLE, ALLOCATED, DOWN, … with its flags."""
        found = re.search(r"State=(\S+)", self._run("scontrol", "show", "node", node))
        assert found
        return found[1]

    def jobs(self) -> dict[str, tuple[str, str]]:
        """By id: state and node; of a job without a node why it waits, in brackets."""
        lines = self._run("squeue", "--noheader", "--format=%i %T %R").splitlines()
        return {job: (state, where) for job, state, where in (line.split(maxsplit=2) for line in lines)}

    def start_now(self, job: str) -> None:
        """A job that was returned to the queue waits for about two minutes by default."""
        self._run("scontrol", "update", f"jobid={job}", "StartTime=now")

    def steps(self, node: str | None = None) -> list[int]:
        """The processes slurmstepd of our jobs, which outlive slurmd."""
        found, jobs = [], self.jobs() if node else {}
        for each in parents():
            try:
                command = Path(f"/proc/{each}/cmdline").read_bytes().decode(errors="replace")
                environment = Path(f"/proc/{each}/environ").read_bytes().split(b"\0")
            except OSError:
                continue
            match = re.search(r"slurmstepd: \[(\d+)\.", command)
            if match and f"SLURM_CONF={self.conf}".encode() in environment:
                if node is None or jobs.get(match[1], ("", ""))[1] == node:
                    found.append(each)
        return found

    def kill_node(self, node: str) -> int:
        """Kills the daemon of a node and everything that runs there, as a loss of power does; returns how many."""
        doomed = [process for root in (self._ours[node], *self.steps(node)) for process in descendants(root)]
        self._kill(doomed)
        return len(set(doomed))

    @staticmethod
    def _kill(processes: list[int]) -> None:
        for process in processes:
            try:
                os.kill(process, signal.SIGKILL)
            except ProcessLookupError:
                continue

    def _stop(self) -> None:
        doomed = {process for step in self.steps() for process in descendants(step)}
        for name in ("n1", "n2", "slurmctld", "munged"):
            if name in self._ours:
                doomed.update(descendants(self._ours[name]))
        self._kill(sorted(doomed))
        until("end of Slurm", lambda: not any(map(is_running, doomed)))
