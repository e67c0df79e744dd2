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
<float name="radius" value="0.6"/></shape></scene>
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
ranks 2 noise --noise 0.02 --json
near "$out" samples 64
expect 1 mpirun --oversubscribe -n 2 "$relume" render "$folder/none.xml" -o "$folder/x.exr"
contains "$err" "none.xml"
finish
