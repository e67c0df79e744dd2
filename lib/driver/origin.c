// SPDX-License-Identifier: Apache-2.0
#include "driver/origin.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "transport/tensor_meaning.h"

// The last value of each name, as the reader has it.
static void add_defines(const struct scene_options *o, struct json *defines) {
    for (size_t i = 0; i < o->define_count; i++) {
        bool last = true;
        for (size_t k = i + 1; k < o->define_count; k++)
            last = last && strcmp(o->defines[i].name, o->defines[k].name) != 0;
        if (last)
            json_add_text(defines, o->defines[i].name, o->defines[i].value);
    }
}

void origin_add(struct json *meta, const struct job *job, const struct job_options *o) {
    char hash[32];
    snprintf(hash, sizeof hash, "%016" PRIx64, job->scene->hash);
    json_add_text(meta, "scene", o->scene);
    json_add_text(meta, "scene hash", hash);
    add_defines(&o->reading, json_add_object(meta, "defines"));
    if (o->light)
        json_add_text(meta, "light", o->light);
}

// "-D NAME=VALUE" of each.
static const char *tell_defines(const struct json *defines, char *text, size_t size) {
    size_t used = 0;
    snprintf(text, size, "none");
    for (size_t i = 0; i < json_count(defines) && used < size; i++) {
        const char *name = json_key(defines, i), *value = json_text(json_get(defines, name));
        used += (size_t)snprintf(text + used, size - used, "%s-D %s=%s", i ? " " : "", name,
                                 value ? value : "");
    }
    return text;
}

bool origin_agrees(const struct json *meta, const char *tensor, const struct job *job,
                   const struct job_options *o) {
    const char *hash = json_text(json_get(meta, "scene hash"));
    const struct json *defines = json_get(meta, "defines"); // files of before lack them
    struct json *own = json_new_object();
    origin_add(own, job, o);
    const char *own_hash = json_text(json_get(own, "scene hash"));
    bool same = hash && strcmp(hash, own_hash) == 0;
    if (!same) {
        log_error("%s: is not the scene that %s was made of (its hash is %s, expected %s)", o->scene,
                  tensor, own_hash, hash ? hash : "one");
    } else if (defines && !tensor_same_value(defines, json_get(own, "defines"))) {
        char there[500], here[500];
        log_error("%s: %s was made of it with other parameters: found %s, expected %s", o->scene, tensor,
                  tell_defines(json_get(own, "defines"), here, sizeof here),
                  tell_defines(defines, there, sizeof there));
        same = false;
    }
    json_destroy(own);
    return same;
}
