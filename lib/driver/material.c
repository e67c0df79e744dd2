// SPDX-License-Identifier: Apache-2.0
#include "driver/material.h"

#include <string.h>

#include "base/file.h"
#include "bsdf/editable_convert.h"
#include "driver/job.h"

// The model that reads files of that extension, or NULL.
static const char *model_for(const char *extension) {
    static const char *const models[][2] = {{"binary", "merl"}, {"bsdf", "measured"},
                                            {"brdf", "goniometer"}, {"dat", "goniometer"},
                                            {"transfer", "goniometer"}};
    for (size_t i = 0; i < sizeof models / sizeof *models; i++)
        if (strcmp(models[i][0], extension) == 0)
            return models[i][1];
    return NULL;
}

// XML is a scene, or a window material.
static bool is_window(const char *path) {
    size_t size;
    char *text = file_read(path, 0, &size);
    const bool window = text && strstr(text, "<WindowElement") != NULL;
    mem_free(text);
    return window;
}

static const char *element_for(enum param_type type) {
    switch (type) {
    case PARAM_BOOL: return "boolean";
    case PARAM_INT: return "integer";
    case PARAM_REFLECTANCE:
    case PARAM_EMISSION:
    case PARAM_INDEX:
    case PARAM_TEXTURE:
    case PARAM_TEXTURE_EMISSION: return "rgb";
    case PARAM_POINT: return "point";
    case PARAM_VECTOR: return "vector";
    case PARAM_FLOAT:
    case PARAM_TEXTURE_SCALAR: return "float";
    default: return "string";
    }
}

// Whether a value is a number, for parameters that also take names.
static bool is_number(const char *value) {
    return strspn(value, "0123456789+-.eE") == strlen(value) && *value;
}

static const char *escape(struct arena *a, const char *text) {
    char *out = arena_alloc(a, 6 * strlen(text) + 1), *p = out;
    for (; *text; text++) {
        const char *entity = *text == '&'    ? "&amp;"
                             : *text == '<'  ? "&lt;"
                             : *text == '"'  ? "&quot;"
                                             : NULL;
        if (entity)
            p = stpcpy(p, entity);
        else
            *p++ = *text;
    }
    return out;
}

// The model and its parameters as a scene of one material.
static const char *compose(const struct material_request *request, const char *model,
                           const char *filename, struct arena *a) {
    const struct entry *e = registry_find(&bsdfs, model);
    const char *text = arena_printf(a, "<scene version=\"3.0.0\"><bsdf type=\"%s\" id=\"material\">",
                                    escape(a, model));
    if (filename)
        text = arena_printf(a, "%s<string name=\"filename\" value=\"%s\"/>", text,
                            escape(a, filename));
    for (size_t i = 0; i < request->define_count; i++) {
        const struct scene_define *d = &request->defines[i];
        const struct param *p = e ? param_find(e, d->name) : NULL;
        const char *element = p ? element_for(p->type) : "string";
        if (p && p->type == PARAM_IOR && is_number(d->value))
            element = "float";
        text = arena_printf(a, "%s<%s name=\"%s\" value=\"%s\"/>", text, element,
                            escape(a, d->name), escape(a, d->value));
    }
    return arena_printf(a, "%s</bsdf><sensor type=\"perspective\"/></scene>", text);
}

static bool prepare(struct scene *s) {
    for (uint32_t i = 0; i < s->texture_count; i++) {
        const struct texture_type *type = texture_type_of(s->textures[i]);
        if (type->prepare && !type->prepare(s->textures[i], &s->arena))
            return false;
    }
    for (uint32_t i = 0; i < s->bsdf_count; i++) {
        const struct bsdf_type *type = bsdf_type_of(s->bsdfs[i]);
        if (type->prepare && !type->prepare(s->bsdfs[i], &s->arena))
            return false;
    }
    return true;
}

static bool choose(struct material *m, const struct material_request *request, const char *id) {
    const struct scene *s = m->scene;
    struct object *chosen = !id && s->bsdf_count == 1 ? s->bsdfs[0] : NULL;
    for (uint32_t i = 0; i < s->bsdf_count; i++)
        if (id && s->bsdfs[i]->id && strcmp(s->bsdfs[i]->id, id) == 0)
            chosen = s->bsdfs[i];
    m->object = chosen;
    if (chosen)
        return !request->editable || !editable_converts(chosen) ||
               editable_convert(chosen, &m->scene->arena);
    const char *ids = "";
    for (uint32_t i = 0; i < s->bsdf_count; i++)
        if (s->bsdfs[i]->id)
            ids = arena_printf(&m->arena, "%s %s", ids, s->bsdfs[i]->id);
    log_error("%s: %s%s; --id takes one of:%s", request->what,
              id ? "no material has the id " : "holds several materials", id ? id : "", ids);
    return false;
}

bool material_open(struct material *m, const struct material_request *request) {
    char extension[16];
    *m = (struct material){0};
    file_extension(request->what, extension, sizeof extension);
    const char *model = model_for(extension), *filename = request->what;
    const bool xml = strcmp(extension, "xml") == 0;
    if (xml && is_window(request->what))
        model = "window";
    struct scene_options options = {.registries = job_registries(), .threads = 1};
    if (!model && !xml) {
        model = request->what;
        filename = NULL;
    }
    if (model) {
        options.text = compose(request, model, filename, &m->arena);
    } else {
        options.defines = request->defines;
        options.define_count = request->define_count;
    }
    m->scene = scene_read(model ? "command-line.xml" : request->what, &options);
    if (m->scene && choose(m, request, model ? "material" : request->id) && prepare(m->scene))
        return true;
    material_close(m);
    return false;
}

void material_close(struct material *m) {
    const struct scene *s = m->scene;
    for (uint32_t i = 0; s && i < s->texture_count; i++)
        if (texture_type_of(s->textures[i])->finish)
            texture_type_of(s->textures[i])->finish(s->textures[i]->data);
    scene_destroy(m->scene);
    arena_finish(&m->arena);
    *m = (struct material){0};
}

const struct closure *material_at(const struct material *m, vec3 wo, struct closure_stack *stack) {
    const struct bsdf_point point = {
        .at = {.uv = {0.5f, 0.5f}}, .frame = {v3(1, 0, 0), v3(0, 1, 0), v3(0, 0, 1)},
        .dpdu = v3(1, 0, 0), .dpdv = v3(0, 1, 0)};
    stack->used = 0;
    return bsdf_resolve(m->object, &point, wo, stack);
}
