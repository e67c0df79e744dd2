#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# relume info of a scene: what it holds, requires and does not require.
#
# usage: info.sh RELUME
set -u
relume=$1
data=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../data" && pwd)
# shellcheck source=tests/tool/pictures.sh
. "$(dirname "${BASH_SOURCE[0]}")/pictures.sh"

# lists JSON KEY WORD: the array under KEY holds WORD
lists() {
    python3 -c 'import json, sys; sys.exit(sys.argv[3] not in json.loads(sys.argv[1])[sys.argv[2]])' \
        "$@" || fail "'$3' is not listed under $2"
}

# Two triangles of the ground and twelve of a cube that stands twice.
scene=$data/scenes/everything.xml
expect 0 "$relume" info "$scene" --json
near "$out" geometry.triangles 14
near "$out" geometry.triangles_with_instances 26
near "$out" geometry.vertices 28
near "$out" geometry.quadrics 4
near "$out" geometry.instances 2
near "$out" shapes.sphere 2
near "$out" lights.point 1
near "$out" textures.checkerboard 3
near "$out" width 16
near "$out" crop.0 4
near "$out" crop.2 12
near "$out" samples 4
near "$out" integrator_parameters.max_depth 6
near "$out" bounds_max.0 10
near "$out" warnings 0
# vertices: position 12, normal 12, uv 8; triangles: 12
near "$out" bytes.meshes $((28 * 32 + 14 * 12))
for feature in textures instancing straight-through-shadow-rays tangents delta-lights environment; do
    lists "$out" requires $feature
done
lists "$out" does_not_require mesh-attributes
expect 0 "$relume" info "$scene"
contains "$out" "sampler: multijitter"
contains "$out" "triangles_with_instances: 26"

expect 0 "$relume" info "$scene" --json -D res=32 -D spp=9 --threads 1
near "$out" width 32
near "$out" samples 9
expect 1 "$relume" info "$scene" -D ress=32
contains "$err" "res?"
expect 2 "$relume" info "$scene" -D res
expect 1 "$relume" info "$folder/none.xml"
contains "$err" "none.xml"

plain=$folder/plain.xml
cat >"$plain" <<'END'
<scene version="3.0.0">
    <sensor type="perspective">
        <float name="fov" value="40"/>
        <film type="hdrfilm"><integer name="widht" value="8"/></film>
    </sensor>
    <shape type="disk"><emitter type="area"/></shape>
</scene>
END
expect 1 "$relume" info "$plain"
contains "$err" 'did you mean "width"?'
expect 0 "$relume" info "$plain" --lenient --json
near "$out" warnings 1
near "$out" geometry.triangles 0
lists "$out" requires area-lights
lists "$out" requires quadrics
for feature in textures instancing straight-through-shadow-rays tangents delta-lights environment \
    light-choice glossy-materials; do
    lists "$out" does_not_require $feature
done
finish
