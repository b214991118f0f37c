#!/usr/bin/env bash
# The frames of a scene as an array job of Slurm: 60 tasks of 4 frames each.
#
#     sbatch examples/farm/slurm.sh SCENE.sdf FOLDER
#
# A task that failed is run again by `sbatch --array=17 …` with its number.
#SBATCH --job-name=surefoot
#SBATCH --array=0-59
#SBATCH --cpus-per-task=4
#SBATCH --mem=2G
#SBATCH --time=00:30:00
#SBATCH --requeue
set -euo pipefail
piece=4
first=$((piece * SLURM_ARRAY_TASK_ID))
mkdir -p "$2"
# The processor draws the same bytes on every machine of one kind.
surefoot render "$1" -o "$2/frame.png" --frames "$first..$((first + piece))" --device cpu
