#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# relume denoise: without the library a message that says what is missing; with it less error against
# truth, and the label.
# usage: denoise.sh RELUME
set -uo pipefail

relume=$(realpath "$1")
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
cd "$folder" || exit 1
failures=0
fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}
scene=$root/data/scenes/cornell-box/scene.xml
"$relume" render "$scene" -o in.exr --size 64x64 --spp 16 --aov albedo,N --variance -q || fail rendering
if ! "$relume" denoise in.exr -o out.exr 2>log; then
    grep -q "libOpenImageDenoise.so.2 was not found" log || fail "no reason was given"
    [ ! -e out.exr ] || fail "a picture was written"
    [ "$failures" = 0 ] && exit 77 # the rest needs the library
    exit 1
fi
"$relume" render "$scene" -o ref.exr --size 64x64 --spp 512 --seed 5 -q || fail rendering
text=$("$relume" info out.exr) || fail info
grep -q "relume.denoised: Open Image Denoise .*with albedo and normals" <<<"$text" || fail "no label"
grep -qE "variance|relume.noise" <<<"$text" && fail "variances of another picture"
error() {
    "$relume" compare ref.exr "$1" --json | python3 -c 'import json, sys; print(json.load(sys.stdin)["relmse"]["value"])'
}
before=$(error in.exr) after=$(error out.exr)
echo "relMSE $before, denoised $after"
python3 -c "import sys; sys.exit(not $after < 0.5 * $before)" || fail "not better"
exit "$((failures > 0))"
