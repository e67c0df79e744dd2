#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The lines of the README for render farms, as they stand there: GNU parallel, where it is installed,
# and the job array of Slurm, by sbatch where a cluster answers, else by its tasks one after the other.
# Their parts united are the picture of one run, bit for bit.
#
# usage: farm.sh RELUME
set -u
relume=$(realpath "$1")
readme=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)/README.md
# shellcheck source=tests/tool/pictures.sh
. "$(dirname "${BASH_SOURCE[0]}")/pictures.sh"

cd "$folder" || exit 1
mkdir bin
ln -s "$relume" bin/relume
PATH=$folder/bin:$PATH
# The program looks for its modules beside itself; none is needed here.
cat >scene.xml <<'END'
<scene version="3.0.0"><integrator type="path"/><emitter type="constant"/>
<sensor type="perspective"><transform name="to_world"><lookat origin="0 0 4" target="0 0 0" up="0 1 0"/>
</transform><film type="hdrfilm"><integer name="width" value="6"/><integer name="height" value="5"/></film>
</sensor><shape type="sphere"/></scene>
END

# The README's lines that hold these words, without their indent.
lines() {
    grep -E "^    .*($1)" "$readme" | sed 's/^    //'
}

# same A B: the same pixels.
same() {
    expect 0 relume compare "$1" "$2" --fail-above mse=0 --json
}

expect 0 relume render scene.xml -o one.exr --samples 0:1024 -q
if command -v parallel >/dev/null; then
    lines 'parallel relume|merge part0.exr' | sed 's/relume render/relume render -q/' >job.sh
    [ "$(wc -l <job.sh)" -eq 2 ] || fail "the README has no lines for GNU parallel"
    expect 0 bash -e job.sh
    same one.exr whole.exr
else
    echo "GNU parallel is not installed"
fi

rm -f part*
{
    echo '#!/bin/bash'
    lines '#SBATCH|SLURM_ARRAY_TASK_ID'
} >array.sh
[ "$(wc -l <array.sh)" -eq 3 ] || fail "the README has no job array"
expect 0 relume render scene.xml -o one.exr --samples 0:4096 -q
if command -v sbatch >/dev/null && sinfo >/dev/null 2>&1; then
    expect 0 sbatch --wait --output=/dev/null array.sh
else
    for task in $(seq 0 15); do
        expect 0 env SLURM_ARRAY_TASK_ID="$task" bash -e array.sh
    done
fi
expect 0 relume merge part*.exr -o whole.exr -q
same one.exr whole.exr
finish
