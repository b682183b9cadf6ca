"""Submits a file to Slurm: an array job that renders frames or parts of them, and one that merges the parts.

`rayleaf farm` runs this, after it has asked Blender what is in the file.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import time
from pathlib import Path

import plan as plans

RUN_TASK = Path(__file__).with_name("run_task.py")
_POLL_SECONDS = 2.0


def arguments() -> argparse.Namespace:
    """Checked by the script `rayleaf`, as far as that can be done without the file."""
    parser = argparse.ArgumentParser(prog="rayleaf farm")
    parser.add_argument("--rayleaf", required=True)
    parser.add_argument("--file", type=Path, required=True)
    parser.add_argument("--output", required=True)
    parser.add_argument("--known", type=json.loads, required=True, help="what describe_file.py says")
    parser.add_argument("--start", type=int, required=True)
    parser.add_argument("--end", type=int, required=True)
    parser.add_argument("--tiles", type=int, default=1)
    parser.add_argument("--samples-per-job", type=int)
    parser.add_argument("--wait", action="store_true")
    parser.add_argument("slurm", nargs="*")
    return parser.parse_args()


def plan_of(options: argparse.Namespace) -> plans.Plan:
    """All frames of the range, cut as the options say."""
    least, most = options.known["samples"]
    ranges = min(least, -(-most // options.samples_per_job)) if options.samples_per_job else 1
    frames = list(range(options.start, options.end + 1, options.known["step"]))
    content = plans.content_of(options.file)
    version = plans.version_of_checkout()
    return plans.Plan(str(options.file), content, version, options.output, frames, options.tiles, ranges)


def slurm(*command: str) -> str:
    """What a command of Slurm says. Ends this program if it fails."""
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"rayleaf: {command[0]} failed: {done.stderr.strip() or done.stdout.strip()}")
    return done.stdout.strip()


def largest_array() -> int:
    """How many tasks an array job may have here."""
    found = re.search(r"MaxArraySize\s*=\s*(\d+)", slurm("scontrol", "show", "config"))
    return int(found[1]) - 1 if found else 1000


def ranges(numbers: list[int]) -> str:
    """ "1-3,7" of 1, 2, 3, 7."""
    spans: list[list[int]] = []
    for number in numbers:
        if spans and number == spans[-1][1] + 1:
            spans[-1][1] = number
        else:
            spans.append([number, number])
    return ",".join(str(first) if first == last else f"{first}-{last}" for first, last in spans)


class Submission:
    """Array jobs of one plan."""

    def __init__(self, options: argparse.Namespace, plan: plans.Plan) -> None:
        self._options, self._plan = options, plan
        self._plan_file = plan.folder / f"plan-{time.strftime('%Y%m%d-%H%M%S')}-{os.getpid()}.json"
        self._most = largest_array()

    def submit(self, kind: str, tasks: list[plans.Task], after: list[str]) -> list[str]:
        """The numbers of the jobs that will do those tasks that are not finished."""
        waiting = [number for number, task in enumerate(tasks) if not self._plan.is_finished(task)]
        jobs = []
        for offset in range(0, len(tasks), self._most):
            if mine := [number - offset for number in waiting if offset <= number < offset + self._most]:
                jobs.append(self._submit_array(kind, offset, mine, after))
        return jobs

    def _submit_array(self, kind: str, offset: int, numbers: list[int], after: list[str]) -> str:
        self._plan_file.parent.mkdir(parents=True, exist_ok=True)
        self._plan.write(self._plan_file)
        logs = self._plan.folder / "logs"
        logs.mkdir(exist_ok=True)
        own = self._options.slurm or ["--exclusive"]
        command = ["sbatch", "--parsable", "--requeue", "--open-mode=append", f"--array={ranges(numbers)}"]
        command += [f"--job-name=rayleaf-{Path(self._plan.output).name}", f"--output={logs}/{kind}-%A-%a.log", *own]
        # Whatever became of the parts: frames that are complete are merged, and a merge says what its frame lacks.
        command += [f"--dependency=afterany:{':'.join(after)}"] if after else []
        command += [str(RUN_TASK.with_suffix(".sh")), self._options.rayleaf, str(self._plan_file), kind, str(offset)]
        return slurm(*command).split(";")[0]


def still_queued(jobs: list[str]) -> list[str]:
    """Those that Slurm has not ended. It forgets what ended long ago."""
    shown = subprocess.run(["squeue", "-h", "-o", "%F", "-j", ",".join(jobs)], capture_output=True, text=True).stdout
    return sorted({*shown.split()} & {*jobs})


def refuse_a_second_one(plan: plans.Plan) -> None:
    """Two submissions would render the same parts."""
    known = plan.folder / "jobs"
    jobs = known.read_text().split() if known.is_file() else []
    if jobs and (queued := still_queued(jobs)):
        sys.exit(f"rayleaf: {plan.output} is rendered already, by job {', '.join(queued)}: wait, or `scancel` first")


def unfinished(plan: plans.Plan) -> list[str]:
    """Frames without pictures."""
    last = plan.merges() or plan.parts()
    return [str(task.frame) for task in last if not plan.is_finished(task)]


def main() -> None:
    options = arguments()
    plan = plan_of(options)
    refuse_a_second_one(plan)
    submission = Submission(options, plan)
    parts = submission.submit("parts", plan.parts(), [])
    merges = submission.submit("merges", plan.merges(), parts)
    if not parts + merges:
        print(f"all frames are there: {plan.output}_*.exr")
        return
    (plan.folder / "jobs").write_text("\n".join(parts + merges) + "\n")
    print(f"submitted: {len(plan.parts())} tasks for {len(plan.frames)} frames, job {', '.join(parts + merges)}")
    print(f"pictures: {plan.output}_*.exr\nlogs: {plan.folder / 'logs'}", flush=True)
    if options.wait:
        while still_queued(parts + merges):
            time.sleep(_POLL_SECONDS)
        if missing := unfinished(plan):
            sys.exit(f"rayleaf: frames without pictures: {', '.join(missing)}; the logs say why. Submit again to go on")


if __name__ == "__main__":
    main()
