"""A farm of 60 cases on a real Slurm with two nodes on this machine: `make cluster`. A node dies on the way and returns.

    farm_on_slurm.py FOLDER       FOLDER: new; holds Slurm's files, its logs, and the farm
"""

from __future__ import annotations

import os
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import dask
import weft
from dask_jobqueue import SLURMCluster  # type: ignore[import-untyped,import-not-found,unused-ignore]
from distributed import Client
from slurm import Slurm, until

DT, STEPS, CASES = 1 / 60, 160, 60


def make_world(case: dict[str, Any]) -> weft.World:
    world = weft.World()
    sheet = world.add_cloth(weft.grid(cells=(40, 40)), fabric=case["fabric"], position=(0, case["height"], 0), name="sheet")
    sheet.pin(sheet.corners[:2])
    return world


def measure(world: weft.World) -> dict[str, Any]:
    return {"lowest": world.cloths[0].positions[:, 1].min(), "node": os.environ.get("SLURMD_NODENAME", "")}


def counting(log: str) -> Any:
    """A control that writes a line for each step."""

    def control(world: weft.World, step: int) -> None:
        handle = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        os.write(handle, f"{world.cloths[0].name} {step}\n".encode())
        os.close(handle)

    return control


def lone_hash(case: dict[str, Any]) -> str:
    world = make_world(case)
    for _ in range(STEPS):
        world.step(DT)
    return world.state_hash()


class Accident:
    """Node n2 dies after a sixth of the cases. It returns once Slurm has noticed, and its job is started again."""

    def __init__(self, slurm: Slurm) -> None:
        self._slurm, self._stage, self._start = slurm, 0, time.monotonic()

    def say(self, text: str) -> None:
        print(f"{time.monotonic() - self._start:5.1f} s  {text}", flush=True)

    def __call__(self, done: int, count: int, spent: float, left: float) -> None:
        if self._stage == 0 and done >= count / 6 and self._slurm.steps("n2"):
            self.say(f"{done} of {count} cases; node n2 dies: {self._slurm.kill_node('n2')} processes are killed")
            self._stage = 1
        elif self._stage == 1 and "DOWN" in self._slurm.state("n2"):
            self.say(f"{done} of {count} cases; Slurm reports n2 as {self._slurm.state('n2')}; its daemon starts again")
            self._slurm.start_node("n2")
            self._stage = 2
        elif self._stage == 2 and "DOWN" not in self._slurm.state("n2"):
            for job, (_, where) in self._slurm.jobs().items():
                if where == "(BeginTime)":
                    self._slurm.start_now(job)
            if any(node == "n2" for _, node in self._slurm.jobs().values()):
                self.say(f"{done} of {count} cases; n2 is back and has its job: {self._slurm.state('n2')}")
                self._stage = 3

    @property
    def is_over(self) -> bool:
        return self._stage == 3


def main() -> int:
    folder = Path(sys.argv[1]).absolute()
    folder.mkdir(parents=True)
    log = folder / "steps.log"
    # dask cancels the job of a worker that stays away for so long; Slurm starts it again when its node returns.
    dask.config.set({"distributed.deploy.lost-worker-timeout": "1 day"})
    cases = weft.farm.grid(fabric=["denim", "silk", "cotton_shirting"], height=[n / 20 for n in range(CASES // 3)])
    with Slurm(folder) as slurm:
        cluster = SLURMCluster(
            queue="main", cores=1, processes=1, memory="1GB", job_cpu=1, walltime="01:00:00", python=sys.executable,
            job_extra_directives=["--requeue"], job_directives_skip=["--mem"],
            job_script_prologue=[f"export PYTHONPATH={os.environ.get('PYTHONPATH', '')}:{Path(__file__).parent}"],
            scheduler_options={"host": "tcp://127.0.0.1:0", "dashboard_address": "127.0.0.1:0"},
            worker_extra_args=["--host", "127.0.0.1", "--dashboard-address", "127.0.0.1:0"],
            local_directory=str(folder / "workers"), log_directory=str(folder / "jobs"),
        )  # fmt: skip
        with cluster, Client(cluster) as client:
            cluster.scale(jobs=2)
            until("start of both workers", lambda: len(client.nthreads()) == 2)
            accident = Accident(slurm)
            accident.say("two workers, on n1 and n2")
            table = weft.farm.run(
                make_world, cases, measure=measure, control=counting(str(log)), seconds=STEPS * DT, dt=DT,
                out=folder / "farm", client=client, progress=accident, checkpoint_every=0.25,
            )  # fmt: skip
            accident.say(f"{table.num_rows} of {len(cases)} cases")
            until("end of the jobs", lambda: (cluster.scale(0), not slurm.jobs())[1])
    steps = len(log.read_text().splitlines())
    last = Counter(line.split()[1] for line in log.read_text().splitlines())[str(STEPS - 1)]
    hashes = [lone_hash(case) for case in cases]
    equal = sum(a == b for a, b in zip(table["state_hash"].to_pylist(), hashes, strict=True))
    rows = weft.farm.table(folder / "farm").num_rows
    nodes = dict(Counter(table["node"].to_pylist()))
    print(f"rows: {rows}; failed: {len(cases) - table['error'].null_count}; by node: {nodes}")
    print(f"cases computed twice: {last - len(cases)}; steps computed twice: {steps - STEPS * len(cases)} of {steps}")
    print(f"hashes equal to those of lone runs: {equal} of {len(cases)}")
    good = rows == equal == len(cases) and accident.is_over
    print("passed" if good else f"failed; logs are in {folder}")
    return int(not good)


if __name__ == "__main__":
    sys.exit(main())
