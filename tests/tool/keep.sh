#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Nothing is lost: limits, journals, killing and resuming, ranges, seeds, crops, merging. Pictures
# are compared bit for bit (--fail-above mse=0).
#
# usage: keep.sh RELUME         RELUME_TEST_FULL: kill 50 times instead of 8
set -u
relume=$1
# shellcheck source=tests/tool/pictures.sh
. "$(dirname "${BASH_SOURCE[0]}")/pictures.sh"
kills=8
[ -z "${RELUME_TEST_FULL:-}" ] || kills=50

cat >"$folder/room.xml" <<END
<scene version="3.0.0"><integrator type="path"/>
<sensor type="perspective"><float name="fov" value="60"/><transform name="to_world">
<lookat origin="0,1,4" target="0,0.5,0" up="0,1,0"/></transform><sampler type="sobol"/>
<film type="hdrfilm"><integer name="width" value="45"/><integer name="height" value="37"/>
<rfilter type="gaussian"/></film></sensor>
<emitter type="constant" id="sky"><rgb name="radiance" value="0.1,0.2,0.3"/></emitter>
<shape type="rectangle"><transform name="to_world"><scale value="3"/><rotate x="1" angle="-90"/>
</transform></shape>
<shape type="sphere"><point name="center" x="0" y="0.6" z="0"/><float name="radius" value="0.6"/>
<bsdf type="roughconductor"/></shape>
<shape type="rectangle" id="lamp"><transform name="to_world"><scale value="0.4"/>
<rotate x="1" angle="90"/><translate y="2.5"/></transform><emitter type="area"/></shape></scene>
END
scene=$folder/room.xml
options=(--variance --light-groups --aov "N,shape" --quiet)

# render NAME OPTION...: NAME.exr in the folder
render() {
    local name=$1
    shift
    expect 0 "$relume" render "$scene" -o "$folder/$name.exr" "${options[@]}" "$@"
}

# same A B: the same decoded pixels
same() {
    expect 0 "$relume" compare "$folder/$1.exr" "$folder/$2.exr" --fail-above mse=0
}

# merged OUT PART...
merged() {
    local name=$1 parts=() part
    shift
    for part; do parts+=("$folder/$part.exr"); done
    expect 0 "$relume" merge "${parts[@]}" -o "$folder/$name.exr" --quiet
}

# refused WORDS PART...
refused() {
    local words=$1 parts=() part
    shift
    for part; do parts+=("$folder/$part.exr"); done
    expect 1 "$relume" merge "${parts[@]}" -o "$folder/refused.exr"
    contains "$err" "$words"
    [ ! -e "$folder/refused.exr" ] || fail "a refused merge wrote a file"
}

spp=448
render whole --spp $spp
render other --seed 1 --spp 4
expect 1 "$relume" compare "$folder/whole.exr" "$folder/other.exr" --fail-above mse=0
contains "$err" "exceeds the limit" # the comparison can fail, for this reason

# Killed at random moments until it is done: the same bits as the run that was left alone.
run=("$relume" render "$scene" -o "$folder/killed.exr" "${options[@]}" --spp "$spp" --checkpoint 0.01
    --resume)
RANDOM=4711
for ((i = 0; i < kills; i++)); do
    timeout -s KILL "0.$(printf %03d $((RANDOM % 400 + 20)))" "${run[@]}" 2>/dev/null
    size=$(stat -c %s "$folder/killed.exr.journal" 2>/dev/null || echo 0)
    if [ $((i % 5)) = 4 ] && [ "$size" -gt 9000 ]; then # an end that was cut off
        truncate -s -1000 "$folder/killed.exr.journal"
    fi
done
expect 0 "${run[@]}"
same whole killed

# A finished picture is extended; sums of another scene, sampler or layer set are not taken.
render extended --spp 100 --checkpoint 60
render extended --spp $spp --resume
same whole extended
expect 1 "$relume" render "$scene" -o "$folder/extended.exr" "${options[@]}" --spp 999 --resume --paths
contains "$err" "film"
expect 1 "$relume" render "$scene" -o "$folder/extended.exr" "${options[@]}" --spp 999 --resume \
    --max-depth 3
contains "$err" "max_depth=3"
same whole extended # and what was there is still there

# A run that does not resume takes the journal's place when it has something to keep, and says so.
before=$(cksum <"$folder/extended.exr.journal")
timeout -s KILL 1 "$relume" render "$scene" -o "$folder/extended.exr" --spp 1000000 \
    --checkpoint 60 2>"$folder/said"
[ "$before" = "$(cksum <"$folder/extended.exr.journal")" ] || fail "an earlier journal is gone"
contains "$(cat "$folder/said")" "--resume goes on from it"

# Ranges, in any order; merges of merges.
render a --samples 0:64
render b --samples 64:256
render c --samples 256:320
render d --samples 320:448
merged ca c a
merged all d ca b
same whole all
merged all b d a c
same whole all
refused "samples" a b b
expect 1 "$relume" merge "$folder"/{a,b}.exr -o "$folder/refused.exr" --quiet --colour-space acescg
contains "$err" "rec709"
[ ! -e "$folder/refused.exr" ] || fail "a refused merge wrote a file"
refused "no journal" a other
expect 1 "$relume" render "$scene" -o "$folder/x.exr" --samples 100:250
contains "$err" "128:256"
expect 1 "$relume" render "$scene" -o "$folder/x.exr" --samples 0:100000000000000
contains "$err" "1073741824 samples"

# Cryptomatte layers are united with them, and told of where they cannot be. The clamp is summed.
plain=("${options[@]}")
options=(--quiet --cryptomatte "object,material" --clamp 0.2)
render masked --spp 256
for i in 0 1 2 3; do render "mask$i" --samples "$((64 * i)):$((64 * i + 64))"; done
merged masks mask2 mask0 mask3 mask1
same masked masks
merged masks01 mask0 mask1
merged masks mask3 masks01 mask2
same masked masks
render left --samples 0:64 --crop 0,0,20,37
render right --samples 0:64 --crop 20,0,45,37
merged masks right left
render masked --spp 64
same masked masks
expect 0 "$relume" info "$folder/masks.exr" --json
contains "$out" '"cryptomatte/3ae39a5/manifest"'
contains "$out" '"relume.clampedShare"'
options=(--quiet --clamp 0.2)
render bare --samples 64:128
expect 0 "$relume" merge "$folder/mask0.exr" "$folder/bare.exr" -o "$folder/masks.exr"
contains "$err" "left out"
contains "$err" "a clamp removed"
options=(--quiet)
render free --samples 64:128
refused "film" mask0 free
render first --samples 0:64
expect 0 "$relume" merge "$folder"/{free,first}.exr -o "$folder/wide.exr" --quiet --colour-space acescg
render narrow --spp 128 --colour-space acescg
same narrow wide
options=("${plain[@]}")

# The line of the README, where GNU parallel is installed.
if parallel --version 2>/dev/null | grep -q "GNU parallel"; then
    # shellcheck disable=SC2016 # the braces are parallel's, in Perl
    expect 0 env PATH="$(dirname "$relume"):$PATH" parallel --will-cite relume render "$scene" \
        -o "$folder/part{}.exr" --samples '{= $_ = $_ * 64 . ":" . ($_ + 1) * 64 =}' \
        "${options[@]@Q}" ::: 0 1 2 3 4 5 6
    merged farm part5 part1 part0 part3 part6 part4 part2
    same whole farm
fi

# Seeds count as samples of one picture.
render seed0 --samples 0:64 --seed 0
render seed1 --samples 0:64 --seed 1
expect 0 "$relume" merge "$folder/seed1.exr" "$folder/seed0.exr" -o "$folder/seeds.exr" --json --quiet
near "$out" samples 128
expect 1 "$relume" render "$scene" -o "$folder/seed0.exr" "${options[@]}" --spp 128 --seed 1 --resume
contains "$err" "holds samples of seed 0"

# Crops.
render left --samples 0:64 --crop 0,0,21,37
render up --samples 0:64 --crop 21,0,45,5
render down --samples 0:64 --crop 21,5,45,37
merged crops down left up
same seed0 crops
refused "empty" left up
refused "other samples" left b

# Adaptive sampling: the map is the same for ranges, resumed runs and the whole.
render adaptive --adaptive --spp 128
render b0 --adaptive --samples 64:128
render b1 --adaptive --samples 0:64
merged adaptive_parts b0 b1
same adaptive adaptive_parts
render adaptive_resumed --adaptive --spp 50 --resume
render adaptive_resumed --adaptive --spp 128 --resume
same adaptive adaptive_resumed
refused "sample map" seed0 b0

# Limits. --noise: looked at every 64 samples; what was asked for is reached or the code is 3.
expect 0 "$relume" render "$scene" -o "$folder/noise.exr" --noise 0.1 --quiet --json
python3 -c 'import json, sys
r = json.loads(sys.argv[1])
sys.exit(not (0 < r["noise"] <= 0.1 and r["samples"] % 64 == 0))' "$out" || fail "--noise: $out"
expect 3 "$relume" render "$scene" -o "$folder/noise.exr" --noise 1e-6 --spp 64 --quiet
expect 0 "$relume" render "$scene" -o "$folder/time.exr" --time 1 --checkpoint 0.1 --quiet --json
python3 -c 'import json, sys
r = json.loads(sys.argv[1])
sys.exit(not (0.5 < r["seconds"] < 5 and r["samples"] > 0 and 0 < r["keeping_seconds"] < r["seconds"]))
' "$out" || fail "--time: $out"

# Killed and resumed with --time: all samples that it says, and no others, are in the picture.
timeout -s KILL 0.7 "$relume" render "$scene" -o "$folder/timed.exr" "${options[@]}" --time 60 --checkpoint 0.05
expect 0 "$relume" render "$scene" -o "$folder/timed.exr" "${options[@]}" --time 0.2 --resume --json
samples=$(python3 -c 'import json, sys; print(json.loads(sys.argv[1])["samples"])' "$out")
expect 0 "$relume" info "$folder/timed.exr"
contains "$out" "relume.samples: $samples"
render counted --spp "$samples"
same timed counted

# A picture to look at meanwhile.
"$relume" render "$scene" -o "$folder/preview.exr" --time 60 --preview 0.3 --quiet &
pid=$!
for ((i = 0; i < 100; i++)); do
    [ ! -e "$folder/preview.exr" ] || break
    sleep 0.1
done
expect 0 "$relume" info "$folder/preview.exr"
kill -TERM $pid
wait $pid
[ $? = 3 ] || fail "a stopped render did not end with 3"

# Nothing can be written: said before the first sample.
expect 1 timeout 20 "$relume" render "$scene" -o "$folder/none/x.exr" --spp 1000000 --checkpoint 1
contains "$err" "$folder/none"
finish
