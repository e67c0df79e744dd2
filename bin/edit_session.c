// SPDX-License-Identifier: Apache-2.0
#include "edit_session.h"

#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "replay/picture.h"

void edit_session_help(void) {
    printf(
        "\nA session, EDITS.json:\n"
        "  {\"focus\": true, \"terms\": 30,\n"
        "   \"steps\": [{\"set\": \"cup.exponent=40\", \"write\": true},\n"
        "             {\"op\": [\"cup.specular.f_A:amplify-y,0,5,10,20,1.5\"], \"frames\": 5},\n"
        "             {\"curve\": \"cup.specular.f_A=lobe.csv\", \"settle\": true},\n"
        "             {\"reset\": \"cup\", \"light\": \"sun=0.5\"}]}\n"
        "  A step makes its changes, then `frames` pictures (1); with `settle` until they are exact.\n"
        "  `write`: the last one goes to OUT.0001.exr, with the number of the step. `focus`, which\n"
        "  is true unless said, freezes what is not edited (of all curves, one or two are edited at a time:\n"
        "  between two pictures, or in turn), `terms` is the most coefficients a frame may change (0: all).\n");
}

static bool write_numbered(const struct edit_session *s, size_t step, const float *frame) {
    char path[4096];
    const char *output = s->output;
    if (!output) {
        log_error("%s: step %zu writes a picture; expected -o OUT.exr", s->script, step + 1);
        return false;
    }
    const char *point = strrchr(output, '.');
    const int stem = point && !strchr(point, '/') ? (int)(point - output) : (int)strlen(output);
    if (snprintf(path, sizeof path, "%.*s.%04zu%s", stem, output, step + 1, output + stem) >=
        (int)sizeof path) {
        log_error("%s: name is too long", output);
        return false;
    }
    return picture_write(path, s->tensor, frame, NULL, s->command, RELUME_VERSION);
}

bool edit_session_frame(void *session, const struct edit_step *step, const struct edit_timing *t,
                        const float *frame) {
    struct edit_session *s = session;
    struct json *j = json_append_object(s->frames);
    json_add_count(j, "step", (int64_t)t->step + 1);
    json_add_count(j, "frame", t->frame + 1);
    json_add_number(j, "change_seconds", t->change_seconds);
    json_add_number(j, "switch_seconds", t->switch_seconds);
    json_add_number(j, "frame_seconds", t->frame_seconds);
    json_add_count(j, "coefficients", (int64_t)t->coefficients);
    json_add_count(j, "bytes", (int64_t)t->bytes);
    json_add_bool(j, "exact", t->exact);
    if (!s->quiet && !s->json)
        log_info("step %zu frame %u: change %.1f ms, switch %.1f ms, frame %.2f ms, %llu coefficients%s",
                 t->step + 1, t->frame + 1, t->change_seconds * 1e3, t->switch_seconds * 1e3,
                 t->frame_seconds * 1e3, (unsigned long long)t->coefficients,
                 t->exact ? "" : ", not exact yet");
    const bool last = step->settle ? t->exact && t->frame + 1 >= step->frames
                                   : t->frame + 1 == step->frames;
    return !step->write || !last || write_numbered(s, t->step, frame);
}
