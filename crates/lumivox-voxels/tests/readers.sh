#!/bin/sh
# Installs the readers of other programs (Debian, Ubuntu) and lets them read what we write, in every format.
# usage: readers.sh; the readers go into a virtual environment under the build folder.
set -eu
unset CDPATH

say() { printf 'readers: %s\n' "$*" >&2; }
die() { say "$*"; exit 1; }

here=$(cd "$(dirname "$0")" && pwd -P)
root=$(cd "$here/../../.." && pwd -P)
build=${CARGO_TARGET_DIR:-$root/target}
packages='python3-openvdb python3-numpy python3-venv libllvm19'
modules='numpy<2 trimesh pynrrd'

# Newer releases call the module of OpenVDB by its own name.
has_openvdb='
try: import openvdb
except ImportError: import pyopenvdb'

if ! /usr/bin/python3 -c "import numpy, venv, ensurepip$has_openvdb" 2>/dev/null; then
    command -v apt-get >/dev/null || die "there is no apt-get here: install what Debian calls $packages, then run this again."
    sudo=''
    [ "$(id -u)" -eq 0 ] || sudo=sudo
    say "installing $packages."
    $sudo env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=120 update </dev/null >/dev/null ||
        say "not every package list could be refreshed; going on with those that are there."
    # shellcheck disable=SC2086 # one word per package
    $sudo env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=120 install -y --no-install-recommends \
        $packages </dev/null >/dev/null || die "'apt-get install $packages' failed, so that no other program can read our files."
fi

python=$build/readers/bin/python
if ! "$python" -c "import nrrd, numpy, trimesh$has_openvdb" 2>/dev/null; then
    say "installing $modules into $build/readers."
    mkdir -p "$build"
    /usr/bin/python3 -m venv --clear --system-site-packages "$build/readers" || die "python3 -m venv failed."
    # shellcheck disable=SC2086 # one word per module
    "$python" -m pip -q --disable-pip-version-check install $modules || die "'pip install $modules' failed: is there a network?"
fi

cases=$build/reader_cases
rm -rf "$cases"
cd "$root"
cargo run -q -p lumivox-voxels --example reader_cases -- "$cases"
for extension in npz nhdr ply vdb; do
    cargo run -q -p lumivox-app -- voxelize builtin:cornell:0 --resolution 32 -o "$cases/cornell.$extension"
done
"$python" "$here/readers.py" "$cases" --all
