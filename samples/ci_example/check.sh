#!/usr/bin/env bash
# The gate: fails where the drawing, or the model that the project renders from, is not right. Writes JUnit XML and pages into FOLDER.
#   check.sh FOLDER [options of draw.py]
set -uo pipefail
here=$(dirname "${BASH_SOURCE[0]}")
out=${1:?check.sh takes the FOLDER to write to}
shift
mkdir -p "$out"
failed=0

# 1. The project's renderer draws, and limn judges the drawing against the true lines.
python3 "$here/draw.py" "$out/drawing.svg" "$@" || exit 2
limn judge "$out/drawing.svg" --against "$here/shape.toml" --max-missed 1% --max-false 1% --max-displaced 0.25 \
  --junit "$out/judge.xml" -o "$out/judge.html" || failed=1

# 2. The mesh that the project ships instead of the formula is fine enough: its border is right to half a pixel.
limn compare "$here/shape.toml" --surface mesh --level 4 --max-displaced 0.5 --junit "$out/compare.xml" -o "$out/compared" || failed=1
exit $failed
