#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Several processes make the picture of one: the same bits, also with limits, when resumed, and when
# a scene cannot be read. Skipped where there is no mpirun, or the program was built without MPI.
#
# usage: ranks.sh RELUME
set -u
relume=$1
# shellcheck source=tests/tool/pictures.sh
. "$(dirname "${BASH_SOURCE[0]}")/pictures.sh"
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export ASAN_OPTIONS=${ASAN_OPTIONS:-}:detect_leaks=0 # MPI does not give back all it takes
if ! command -v mpirun >/dev/null || ! grep -q MPI_Init "$relume"; then
    echo "no mpirun, or built without MPI"
    exit 77
fi

cat >"$folder/room.xml" <<END
<scene version="3.0.0"><integrator type="path"/>
<sensor type="perspective"><float name="fov" value="60"/><transform name="to_world">
<lookat origin="0,1,4" target="0,0.5,0" up="0,1,0"/></transform><sampler type="sobol"/>
<film type="hdrfilm"><integer name="width" value="150"/><integer name="height" value="70"/>
<rfilter type="gaussian"/></film></sensor>
<emitter type="constant"/><shape type="sphere"><point name="center" x="0" y="0.6" z="0"/>
<float name="radius" value="0.6"/><bsdf type="diffuse" id="ball"/></shape></scene>
END
scene=$folder/room.xml

# ranks N NAME OPTION...: NAME.exr in the folder, made by N processes of one thread
ranks() {
    local n=$1 name=$2
    shift 2
    expect 0 mpirun --oversubscribe -n "$n" "$relume" render "$scene" -o "$folder/$name.exr" \
        --threads 1 --quiet "$@"
}

same() {
    expect 0 "$relume" compare "$folder/$1.exr" "$folder/$2.exr" --fail-above mse=0
}

expect 0 "$relume" render "$scene" -o "$folder/alone.exr" --spp 150 --variance --quiet
for n in 2 3; do
    ranks "$n" together --spp 150 --variance
    same alone together
done
ranks 2 resumed --spp 40 --variance --checkpoint 60
ranks 3 resumed --spp 150 --variance --resume
same alone resumed
# What one process refuses ends all of them.
expect 1 timeout 60 mpirun --oversubscribe -n 2 "$relume" render "$scene" -o "$folder/resumed.exr" --threads 1 \
    --spp 200 --variance --resume --seed 3
contains "$err" "holds samples of seed"
expect 1 timeout 60 mpirun --oversubscribe -n 1 "$relume" render "$scene" -o "$folder/x.exr" --spp 64 : \
    -n 1 "$relume" render "$folder/none.xml" -o "$folder/x.exr" --spp 64
contains "$err" "none.xml"
[ ! -e "$folder/x.exr" ] || fail "a picture without a process that failed"
ranks 2 noise --noise 0.02 --json
near "$out" samples 64

# Tensors for editing with all bounces: whole, in passes, resumed; others are refused.
tensor() {
    local n=$1 name=$2
    shift 2
    expect 0 mpirun --oversubscribe -n "$n" "$relume" precompute edit "$scene" --edit ball \
        -o "$folder/$name.safetensors" --bounces 2 --series 8 --size 75x35 --threads 1 --quiet "$@"
}
# The bytes of values, halves, sums: what follows the header.
data() {
    python3 -c 'import struct, sys, zlib
d = open(sys.argv[1], "rb").read()
print(zlib.crc32(d[8 + struct.unpack("<Q", d[:8])[0]:]))' "$folder/$1.safetensors"
}
tensor 1 one --spp 192 --checkpoint 100
for n in 2 3; do
    tensor "$n" many --spp 192 --checkpoint 100
    [ "$(data one)" = "$(data many)" ] || fail "$n processes make another tensor"
    tensor "$n" passes --spp 64 --resume
    tensor "$n" passes --spp 192 --resume --checkpoint 0.01
    [ "$(data one)" = "$(data passes)" ] || fail "$n processes make another tensor when they resume"
    rm "$folder/passes.safetensors"
done
tensor 1 one --noise 0.05
tensor 2 many --noise 0.05 --json
[ "$(data one)" = "$(data many)" ] || fail "another tensor with --noise"
python3 -c 'import json, sys; sys.exit(not 0 < json.loads(sys.argv[1])["noise"] <= 0.05)' "$out" ||
    fail "--noise: $out"
expect 2 mpirun --oversubscribe -n 2 "$relume" precompute relight "$scene" -o "$folder/x"
contains "$err" "expected one process"

expect 1 mpirun --oversubscribe -n 2 "$relume" render "$folder/none.xml" -o "$folder/x.exr"
contains "$err" "none.xml"
finish
