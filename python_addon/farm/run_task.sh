#!/bin/sh
# What Slurm starts on a node; it gets a copy of this script, so the folder comes from RAYLEAF, the first argument.
exec /usr/bin/python3 "$(dirname "$1")/python_addon/farm/run_task.py" "$@"
