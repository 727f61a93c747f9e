#!/usr/bin/env bash
# Writes the HTML reference of the installed headers into FOLDER: docs/doxygen.sh FOLDER. Fails where Doxygen warns.
set -euo pipefail
folder=$(realpath -m "${1:?docs/doxygen.sh takes the FOLDER to write to}")
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# As limn_public_headers() in CMakeLists.txt: each umbrella, and what it includes from its own folder.
headers=()
for umbrella in sdf/sdf.h subdiv/subdiv.h raymarch/raymarch.h samples/experiment/experiment.h; do
  mapfile -t included < <(sed -n "s|^#include \"\(${umbrella%%/*}/.*\)\"|\1|p" "$umbrella")
  headers+=("$umbrella" "${included[@]}")
done

mkdir -p "$folder/generated/sdf"
LIMN_VERSION=$(sed -n 's/^project(limn VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
sed "s/@PROJECT_VERSION@/$LIMN_VERSION/" sdf/version.h.in >"$folder/generated/sdf/version.h"
headers+=("\"$folder/generated/sdf/version.h\"")

export LIMN_VERSION LIMN_HEADERS="${headers[*]}" LIMN_REFERENCE=$folder
"${DOXYGEN:-doxygen}" docs/Doxyfile
