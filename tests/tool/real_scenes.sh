#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Real scenes of others render with the warnings that they must give and no others. Skips without
# $RELUME_SHARED_DATA.
#
# usage: real_scenes.sh RELUME
set -u
relume=$1
scenes=${RELUME_SHARED_DATA:-}/scenes
[ -d "$scenes" ] || exit 77
# shellcheck source=tests/tool/pictures.sh
. "$(dirname "${BASH_SOURCE[0]}")/pictures.sh"

# warns SCENE [WARNING]: all warnings of a small picture are this one, or none.
warns() {
    local found
    expect 0 "$relume" render "$scenes/$1" -o "$folder/o.exr" --size 16x9 --spp 1
    found=$(grep -o 'warning: .*' <<<"$err" | sed "s|$scenes/||")
    [ "$found" = "${2:+warning: $1:$2}" ] || fail "$1: $found"
}

taken='is not known: "path" takes its place, with its depth'
warns bitterli/classroom/scene.xml "12: integrator \"sppm\" $taken"
warns bitterli/veach-mis/scene_mitsuba3.xml "8: integrator \"path_guiding_integrator\" $taken"
warns bitterli/cornell-box/scene_mitsuba05.xml
warns sponza-dabrovic/sponza.xml
warns matpreview/matpreview.xml
warns cbox-spectral/cbox.xml
finish
