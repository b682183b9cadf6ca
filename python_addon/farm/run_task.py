"""On a node of the farm: one task of an array job. Usage: run_task.py RAYLEAF PLAN parts|merges OFFSET.

A task that fails is queued again, some times; a finished one is not rendered twice.
"""

import os
import subprocess
import sys
from pathlib import Path

import plan as plans

MOST_RESTARTS = 3


def say(text: str) -> None:
    """Into the task's log."""
    print(f"rayleaf farm: {text}", file=sys.stderr, flush=True)


def missing_parts(plan: plans.Plan, frame: int) -> list[str]:
    """Of a frame, those that have not been finished, and which other version has rendered them."""
    missing = [part for part in plan.parts() if part.frame == frame and not plan.is_finished(part)]
    versions = {part.name: plan.rendered_by(part) for part in missing}
    return [f"{name} (but by Rayleaf {version})" if version else name for name, version in versions.items()]


def run(rayleaf: str, plan: plans.Plan, task: plans.Task) -> int:
    """The exit code of `rayleaf render`."""
    if plans.content_of(Path(plan.file)) != plan.content:
        say(f"{plan.file} has changed since it was submitted: submit it again")
        return 2
    if (version := plans.version_of_checkout()) != plan.version:
        say(f"{plan.file} was submitted to Rayleaf {plan.version}, and this is {version}: submit it again")
        return 2
    marker = plan.marker(task)
    marker.unlink(missing_ok=True)
    command = [rayleaf, "render", plan.file, "-o", str(plan.picture(task.frame)), *task.options()]
    code = subprocess.run(command, stdin=subprocess.DEVNULL).returncode
    if code == 0 and plan.makes_pictures(task):
        marker.parent.mkdir(parents=True, exist_ok=True)
        marker.touch()
    return code


def queue_again(task: plans.Task, code: int) -> None:
    """Have Slurm start the task anew, on this node or another; it ends this process then."""
    restarts = int(os.environ.get("SLURM_RESTART_COUNT", "0"))
    if restarts >= MOST_RESTARTS:
        say(f"{task.name} failed (exit code {code}) and was queued again {restarts} times: it is given up")
        return
    say(f"{task.name} failed (exit code {code}) and is queued again")
    job = f"{os.environ['SLURM_ARRAY_JOB_ID']}_{os.environ['SLURM_ARRAY_TASK_ID']}"
    subprocess.run(["scontrol", "requeue", job])


def main() -> int:
    rayleaf, path, kind, offset = sys.argv[1:]
    plan = plans.read(Path(path))
    tasks = plan.merges() if kind == "merges" else plan.parts()
    task = tasks[int(offset) + int(os.environ["SLURM_ARRAY_TASK_ID"])]
    if plan.is_finished(task):
        say(f"{task.name} is there")
        return 0
    if task.merges and (missing := missing_parts(plan, task.frame)):
        say(f"frame {task.frame} cannot be put together: not rendered: {', '.join(missing)}; submit the file again")
        return 1
    code = run(rayleaf, plan, task)
    if code not in (0, 2):
        queue_again(task, code)
    return code


if __name__ == "__main__":
    sys.exit(main())
