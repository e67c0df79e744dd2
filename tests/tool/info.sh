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

# room NAME BODY: a floor and a wall that a camera looks at
room() {
    cat >"$folder/$1.xml" <<END
<scene version="3.0.0">
<sensor type="perspective"><float name="fov" value="60"/><transform name="to_world">
<lookat origin="0,2,6" target="0,1,0" up="0,1,0"/></transform><film type="hdrfilm"/></sensor>
<shape type="rectangle" id="floor"><transform name="to_world"><scale value="4"/>
<rotate x="1" angle="-90"/></transform></shape>
<shape type="rectangle" id="wall"><string name="group" value="walls"/><transform name="to_world">
<scale value="4"/><translate z="-2"/></transform></shape>
$2
</scene>
END
}
ball='<shape type="sphere"><point name="center" x="0" y="2" z="0"/>'
bulb="$ball<float name='radius' value='0.5'/><bsdf type='dielectric'/></shape>"
filament="$ball<float name='radius' value='0.02'/><emitter type='area'><rgb name='radiance' value='900'/></emitter></shape>"
large="$ball<float name='radius' value='0.4'/><emitter type='area'><rgb name='radiance' value='9'/></emitter></shape>"
point='<emitter type="point" id="lamp"><point name="position" x="0" y="2" z="0"/></emitter>'
pane='<shape type="cube"><transform name="to_world"><scale x="9" y="0.05" z="9"/><translate y="5"/></transform><bsdf type="dielectric"/></shape>'
sun='<emitter type="directional"><vector name="direction" x="0.3" y="-1" z="-0.3"/></emitter>'
sky='<emitter type="constant"/>'
side='<emitter type="point"><point name="position" x="-2" y="2" z="1"/></emitter>'
mirror='<shape type="sphere"><point name="center" x="1" y="1" z="0"/><bsdf type="conductor"/></shape>'

looking='<shape type="rectangle"><transform name="to_world"><scale value="2"/><rotate y="1" angle="90"/><translate x="-2.5" y="2" z="1"/></transform><bsdf type="conductor"/></shape>'
small="<shape type='sphere'><point name='center' x='-2' y='2' z='1'/><float name='radius' value='0.02'/><emitter type='area'><rgb name='radiance' value='900'/></emitter></shape>"

# troubles NUMBER WORDS BODY: `info` warns of so many lights, with these words
troubles() {
    room room "$3"
    expect 0 "$relume" info "$folder/room.xml" --json
    python3 -c 'import json, sys; sys.exit(len(json.loads(sys.argv[1])["will_not_converge"]) != int(sys.argv[2]))' \
        "$out" "$1" || fail "not $1 lights that will not converge: $err"
    contains "$err" "$2"
}
troubles 1 'converge slowly' "$bulb$filament"
troubles 1 'will not find the light of "lamp"' "$bulb$point"
troubles 1 'smooth glass' "$pane$sun"
troubles 1 'none of it' "$mirror<emitter type='point'><point name='position' x='0' y='2' z='-9'/></emitter>$sky"
troubles 0 '' "$bulb$large"    # found by one direction in a few
troubles 0 '' "$pane$sky"      # the sky is everywhere
troubles 0 '' "$filament"      # no glass
troubles 0 '' "$bulb$side$sky" # beside the glass
troubles 1 'lamp" that comes by smooth reflection' "$looking${side/emitter /emitter id=\"lamp\" }"
troubles 1 'by smooth reflection, and is found by one path in' "$looking$small"
troubles 0 '' "$looking$large"          # a lamp that paths find
troubles 0 '' "$looking$sky"            # everywhere
troubles 0 '' "${looking/conductor/roughconductor}$side"
troubles 0 '' "${pane/dielectric/thindielectric}$sun"
troubles 1 '9 % of all' "${bulb/dielectric/thindielectric}$point" # what the bulb throws back and forth

# Lists of what lights light, and what the camera does not see.
# A mesh of triangles is one; a serialized file may hold several, of which all are read.
python3 - "$folder" <<'END'
import struct, sys, zlib
def mesh(z, triangles, flags):
    corners = 3 * triangles
    data = struct.pack("<I", 0x1000 | flags) + b"part\0" + struct.pack("<QQ", corners, triangles)
    data += b"".join(struct.pack("<3f", i % 3 == 1, i % 3 == 2, z) for i in range(corners))
    data += struct.pack("<2f", 0, 0) * corners if flags & 2 else b""
    return struct.pack("<HH", 0x041c, 4) + zlib.compress(data + struct.pack(f"<{corners}I", *range(corners)))
parts = [mesh(0, 1, 2), mesh(7, 2, 0), mesh(-1, 4, 2)]
starts = [sum(map(len, parts[:i])) for i in range(3)]
table = struct.pack("<3QI", *starts, 3)
open(sys.argv[1] + "/three.serialized", "wb").write(b"".join(parts) + table)
open(sys.argv[1] + "/bare.serialized", "wb").write(parts[1])
open(sys.argv[1] + "/cut.serialized", "wb").write(b"".join(parts[:2]) + parts[2][:40] + table)
END
expect 0 "$relume" info "$folder/three.serialized" --json
near "$out" meshes 3
near "$out" triangles 7
near "$out" vertices 21
near "$out" uvs 0
near "$out" min.2 -1
near "$out" max.2 7
near "$out" each.1.triangles 2
near "$out" each.2.uvs 1
expect 0 "$relume" info "$folder/three.serialized"
contains "$out" "triangles: 7"
contains "$out" "triangles 4"
expect 0 "$relume" info "$folder/bare.serialized" --json
near "$out" meshes 1
near "$out" triangles 2
expect 1 "$relume" info "$folder/cut.serialized"
contains "$err" "cut.serialized"

# attributed SHAPE NAME BODY: a scene whose one shape wears the attribute NAME
attributed() {
    room worn "<shape type='$1'>$3<bsdf type='twosided'><bsdf type='diffuse'>
<texture name='reflectance' type='product'><texture name='texture_0' type='mesh_attribute'>
<string name='name' value='$2'/></texture></texture></bsdf></bsdf></shape>"
}
printf '%s\n' ply 'format ascii 1.0' 'element vertex 3' 'property float x' 'property float y' 'property float z' \
    'property float r' 'property float g' 'property float b' 'element face 1' \
    'property list uchar int vertex_indices' end_header '0 0 0 1 0 0' '1 0 0 0 1 0' '0 1 0 0 0 1' '3 0 1 2' \
    >"$folder/painted.ply"
painted="<string name='filename' value='painted.ply'/>"
attributed ply vertex_color "$painted"
expect 0 "$relume" info "$folder/worn.xml"
attributed ply vertex_colr "$painted"
expect 1 "$relume" info "$folder/worn.xml"
contains "$err" 'worn.xml:9: mesh_attribute: the shape "ply" of line 8 has no attribute "vertex_colr"; did you mean "vertex_color"?'
attributed ply face_heat "$painted"
expect 1 "$relume" info "$folder/worn.xml"
contains "$err" '"face_heat"; it has vertex_color'
for shape in rectangle sphere; do
    attributed $shape vertex_color ""
    expect 1 "$relume" info "$folder/worn.xml"
    contains "$err" "the shape \"$shape\" of line 8 has no attribute \"vertex_color\"; it has none"
done
room worn "<shape type='cube'><emitter type='area'><texture name='radiance' type='mesh_attribute'>
<string name='name' value='face_glow'/></texture></emitter></shape>"
expect 1 "$relume" info "$folder/worn.xml"
contains "$err" '"face_glow"; it has none'
room worn "<bsdf type='diffuse'><texture name='reflectance' type='mesh_attribute'><string name='name' value='face_glow'/></texture></bsdf>"
expect 0 "$relume" info "$folder/worn.xml" # nothing wears it

# Messages speak as the file does.
printf '<scene version="0.5.0">\n<integrator type="path"><integer name="maxDepht" value="3"/></integrator></scene>\n' >"$folder/old.xml"
expect 1 "$relume" info "$folder/old.xml"
contains "$err" 'has no parameter "maxDepht"; did you mean "maxDepth"?'
room typo "<shape tipe='sphere'/>"
expect 1 "$relume" info "$folder/typo.xml"
contains "$err" 'has no attribute "tipe"; did you mean "type"?'
room typo "<shape kind='sphere'/>"
expect 1 "$relume" info "$folder/typo.xml"
contains "$err" 'has no attribute "kind"; it may have: type id name'
[[ $err != *!* ]] || fail "marks of the table in: $err"
for metal in au AU a-c; do
    expect 1 "$relume" brdf roughconductor -D material=$metal
    contains "$err" "\"$metal\" is not known; did you mean \""
done
contains "$err" '"a-C"'

room linked "<emitter type='point'><string name='exclude' value='floor, walls'/></emitter>"
expect 0 "$relume" info "$folder/linked.xml" --json
lists "$out" requires light-linking
lists "$out" does_not_require camera-visibility
room linked "<emitter type='point'><string name='exclude' value='flor'/></emitter>"
expect 1 "$relume" info "$folder/linked.xml"
contains "$err" '"flor"'
room linked "<emitter type='point'><string name='exclude' value='floor'/><string name='include' value='walls'/></emitter>"
expect 1 "$relume" info "$folder/linked.xml"
contains "$err" "not both"
hidden="$ball<boolean name='visible_to_camera' value='false'/>"
room hidden "$hidden</shape>$sky"
expect 0 "$relume" info "$folder/hidden.xml" --json
lists "$out" requires camera-visibility
room hidden "$hidden<medium name='interior' type='homogeneous'/></shape>$sky"
expect 1 "$relume" info "$folder/hidden.xml"
contains "$err" "hidden from the camera"
finish
