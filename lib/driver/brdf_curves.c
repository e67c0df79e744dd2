// SPDX-License-Identifier: Apache-2.0
// A material as curves: its editable form, whole as JSON (curve/form_json.h), or each curve as a
// table of its own.
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "bsdf/editable_data.h"
#include "curve/form_json.h"
#include "driver/brdf.h"
#include "driver/brdf_factor.h"

static bool form_write(const struct form *f, const char *path) {
    struct json *j = json_new_object();
    form_to_json(f, j, NULL);
    char *text = json_to_text(j);
    const bool written = file_write(path, text, strlen(text));
    mem_free(text);
    json_destroy(j);
    return written;
}

// "OUT.csv" becomes "OUT-TERM-f_A.csv", and so on.
static bool curves_write(const struct form *f, const char *path) {
    const int stem = (int)(strlen(path) - strlen(".csv"));
    for (uint32_t t = 0; t < f->terms; t++)
        for (int s = 0; s < SLOTS; s++) {
            const struct form_slot *slot = &f->term[t].slots[s];
            char name[4096];
            if (slot->gamma.kind == GAMMA_NONE)
                continue;
            snprintf(name, sizeof name, "%.*s-%s-%s.csv", stem, path, f->term[t].name, slot_names[s]);
            if (!curve_write(f->curve[slot->curve].f[0].table, name))
                return false;
        }
    return true;
}

static bool write_form(const struct form *f, const char *path) {
    char extension[16];
    file_extension(path, extension, sizeof extension);
    return strcmp(extension, "json") == 0 ? form_write(f, path) : curves_write(f, path);
}

bool brdf_write_curves(const struct material *m, const char *path) {
    const struct editable *e = m->object->data;
    if (m->object->type == &bsdf_editable.entry)
        return write_form(&e->form, path);
    struct arena arena = {0};
    struct form f = {.terms = 0};
    const bool good = brdf_factor(m, path, &f, &arena) && write_form(&f, path);
    arena_finish(&arena);
    return good;
}
