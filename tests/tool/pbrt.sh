#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# pbrt scenes give the pictures of the Mitsuba scenes that they were written from: by the same random
# numbers nearly so (narrow lobes make other paths of rounding; noise is ten times more), and by others within the noise (means within 4 standard errors of each other:
# false alarms 6e-5 a scene).
#
# usage: pbrt.sh RELUME
set -u
relume=$1
scenes=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../data/scenes" && pwd)
# shellcheck source=tests/tool/pictures.sh
. "$(dirname "${BASH_SOURCE[0]}")/pictures.sh"

spp=32 limit=4e-3 # a tenth of the noise
[ -z "${RELUME_TEST_SANITIZED:-}" ] || spp=8 limit=16e-3
[ "${RELUME_TEST_FULL:-}" != 1 ] || spp=1024

# pair XML PBRT SIZE
pair() {
    expect 0 "$relume" render "$scenes/$1" -o "$folder/a.exr" --size "$3" --spp $spp --sampler sobol --variance -q
    expect 0 "$relume" render "$scenes/$2" -o "$folder/b.exr" --size "$3" --spp $spp --sampler sobol --variance -q
    expect 0 "$relume" compare "$folder/a.exr" "$folder/b.exr" --fail-above relmse=$limit
    expect 0 "$relume" render "$scenes/$2" -o "$folder/c.exr" --size "$3" --spp $spp --sampler sobol --variance -q --seed 7
    expect 0 "$relume" compare "$folder/a.exr" "$folder/c.exr" --json
    python3 - "$2" "$out" <<'END' || fail "$2: the means differ"
import json, sys
mean = json.loads(sys.argv[2])["mean"]
print(sys.argv[1], mean)
sys.exit(not abs(mean["value"] - 1) <= 4 * mean["error"])
END
}

pair cornell-box/scene.xml pbrt/cornell-box.pbrt 64x64
pair pbrt/plates.xml pbrt/plates.pbrt 96x54
pair pbrt/still-life.xml pbrt/still-life.pbrt 96x60
finish
