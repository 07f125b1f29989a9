#!/bin/sh
# Installs the readers of other programs (Debian, Ubuntu; as root) and lets them read every format.
# usage: readers.sh; the readers go into a virtual environment under the build folder.
set -eu
unset CDPATH
here=$(cd "$(dirname "$0")" && pwd -P)
build=${CARGO_TARGET_DIR:-$here/../../../target}
if ! /usr/bin/python3 -c 'import pyopenvdb' 2>/dev/null; then
    apt-get -qq update
    apt-get -qq install -y --no-install-recommends python3-openvdb python3-numpy python3-venv libllvm19
fi
[ -d "$build/readers" ] || /usr/bin/python3 -m venv --system-site-packages "$build/readers"
"$build/readers/bin/pip" -q install 'numpy<2' trimesh pynrrd
cargo run -q -p lumivox-voxels --example reader_cases -- "$build/reader_cases"
"$build/readers/bin/python" "$here/readers.py" "$build/reader_cases" --all
