// SPDX-License-Identifier: Apache-2.0
#include "driver/cryptomatte.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/json.h"
#include "math/murmur.h"
#include "sink/matte.h"

static const struct kind {
    const char *option, *layer;
    uint32_t bit;
} kinds_known[] = {{"object", "CryptoObject", CRYPTOMATTE_OBJECT},
                   {"material", "CryptoMaterial", CRYPTOMATTE_MATERIAL}};

enum { KINDS = sizeof kinds_known / sizeof *kinds_known };

bool cryptomatte_parse(const char *list, uint32_t *kinds) {
    *kinds = 0;
    for (const char *s = list; *s;) {
        const size_t n = strcspn(s, ",");
        int i = 0;
        while (i < KINDS && (strlen(kinds_known[i].option) != n ||
                             strncmp(kinds_known[i].option, s, n) != 0))
            i++;
        if (i == KINDS) {
            log_error("--cryptomatte: found '%.*s', expected object, material or both", (int)n, s);
            return false;
        }
        *kinds |= kinds_known[i].bit;
        s += n + (s[n] == ',');
    }
    return true;
}

// The names of one layer, by number.
struct naming {
    const struct scene *scene;
    bool materials;
    const char **names; // by shape, then by instance; or by material
    uint32_t count;
};

static uint32_t find_bsdf(const struct scene *s, const struct object *bsdf) {
    uint32_t i = 0;
    while (i < s->bsdf_count && s->bsdfs[i] != bsdf)
        i++;
    return i < s->bsdf_count ? i : 0;
}

static uint32_t number_of(const void *context, const struct sink_surface *seen) {
    const struct naming *n = context;
    const struct shape *shape = &n->scene->shapes[seen->shape - 1];
    if (n->materials)
        return find_bsdf(n->scene, shape->bsdf);
    // What is in a group goes by the name of the instance, if that has one.
    const uint32_t instance = n->scene->shape_count + seen->instance - 1;
    return seen->instance && n->names[instance] ? instance : seen->shape - 1;
}

static void make_names(struct naming *n, struct arena *arena) {
    const struct scene *s = n->scene;
    n->count = n->materials ? s->bsdf_count : s->shape_count + s->instance_count;
    n->names = arena_alloc(arena, (n->count + 1) * sizeof *n->names);
    for (uint32_t i = 0; i < n->count; i++) {
        const bool instance = !n->materials && i >= s->shape_count;
        const char *id = n->materials ? s->bsdfs[i]->id
                         : instance   ? s->instances[i - s->shape_count].name
                                      : s->shapes[i].name;
        const char *type = n->materials ? s->bsdfs[i]->type->name : instance ? "" : s->shapes[i].type;
        n->names[i] = id && *id ? id : instance ? NULL : arena_printf(arena, "%s.%u", type, i);
    }
}

// Exponents of zeros, infinities and NaN are avoided (specification, "uint32_to_float32").
static float id_of(const char *name) {
    uint32_t h = murmur3_32(name, strlen(name));
    const uint32_t exponent = h >> 23 & 255;
    float id;
    if (exponent == 0 || exponent == 255)
        h ^= 1u << 23;
    memcpy(&id, &h, sizeof id);
    return id;
}

// It begins with the first seven digits of the layer's hash.
void cryptomatte_key(const char *layer, const char *what, char key[IMAGE_NAME_SIZE]) {
    snprintf(key, IMAGE_NAME_SIZE, "cryptomatte/%.7x/%s", murmur3_32(layer, strlen(layer)) >> 4, what);
}

static void add_attributes(struct image *im, const char *layer, const struct naming *n) {
    char key[IMAGE_NAME_SIZE], hash[16];
    struct json *manifest = json_new_object();
    for (uint32_t i = 0; i < n->count; i++) {
        const float id = n->names[i] ? id_of(n->names[i]) : 0;
        uint32_t bits;
        memcpy(&bits, &id, sizeof bits);
        snprintf(hash, sizeof hash, "%08x", bits);
        if (n->names[i] && !json_get(manifest, n->names[i]))
            json_add_text(manifest, n->names[i], hash);
    }
    char *text = json_to_text(manifest);
    const char *const values[4][2] = {{"name", layer},
                                      {"hash", "MurmurHash3_32"},
                                      {"conversion", "uint32_to_float32"},
                                      {"manifest", text}};
    for (int i = 0; i < 4; i++) {
        cryptomatte_key(layer, values[i][0], key);
        image_set_text(im, key, values[i][1]);
    }
    mem_free(text);
    json_destroy(manifest);
}

bool cryptomatte_is_layer(const char *name) {
    bool known = false;
    for (int i = 0; i < KINDS; i++)
        for (int rank = 0; rank < MATTE_RANKS / 2; rank++) {
            char layer[IMAGE_NAME_SIZE];
            snprintf(layer, sizeof layer, "%s%02d", kinds_known[i].layer, rank);
            known |= strcmp(layer, name) == 0;
        }
    return known;
}

void cryptomatte_add_channels(struct image *im, const char *layer) {
    static const char channels[4] = {'R', 'G', 'B', 'A'};
    const int first = im->channels;
    image_add_channels(im, 2 * MATTE_RANKS);
    for (int c = 0; c < 2 * MATTE_RANKS; c++)
        snprintf(im->channel_names[first + c], IMAGE_NAME_SIZE, "%s%02d.%c", layer, c / 4,
                 channels[c % 4]);
}

static void add_channels(struct image *im, const char *layer, const struct matte *m,
                         const struct naming *n, const struct sink_area *area, double samples) {
    const int first = im->channels;
    cryptomatte_add_channels(im, layer);
    for (int y = area->y0; y < area->y1; y++)
        for (int x = area->x0; x < area->x1; x++) {
            const struct matte_pixel *p = matte_at(m, x, y);
            float *out = im->pixels + ((size_t)(y - area->y0) * (size_t)im->width +
                                       (size_t)(x - area->x0)) * (size_t)im->channels + first;
            for (int r = 0; r < MATTE_RANKS; r++)
                if (p->weights[r] > 0) {
                    out[2 * r] = id_of(n->names[p->names[r]]);
                    out[2 * r + 1] = (float)((double)p->weights[r] / samples);
                }
        }
}

static bool add_layer(const struct job *job, const struct kind *kind, uint64_t samples,
                      struct image *im) {
    const struct film_options *f = &job->film;
    struct arena arena = {0};
    struct naming naming = {.scene = job->scene, .materials = kind->bit == CRYPTOMATTE_MATERIAL};
    make_names(&naming, &arena);
    const struct sink_area area = {f->x0, f->y0, f->x1, f->y1};
    struct matte *m = matte_create(&(struct matte_options){area, number_of, &naming});
    struct tracer_options options = job->render.tracer;
    options.integrator = &integrator_first_hits;
    options.map = NULL;
    options.stop = NULL;
    struct tracer *tracer = tracer_create(&options, matte_sink, m);
    const uint32_t count =
        (uint32_t)(samples < CRYPTOMATTE_SAMPLES ? samples : CRYPTOMATTE_SAMPLES);
    const bool complete =
        tracer_run(tracer, 0, matte_tile_count(m), (uint32_t)f->first, count);
    tracer_destroy(tracer);
    if (complete) {
        add_channels(im, kind->layer, m, &naming, &area, count);
        add_attributes(im, kind->layer, &naming);
    }
    matte_destroy(m);
    arena_finish(&arena);
    return complete;
}

bool cryptomatte_add(const struct job *job, uint32_t kinds, uint64_t samples, struct image *im) {
    char text[64];
    snprintf(text, sizeof text, "%u %" PRIu64 " %" PRIu64, job->film.seed, job->film.first,
             samples < CRYPTOMATTE_SAMPLES ? samples : (uint64_t)CRYPTOMATTE_SAMPLES);
    if (kinds)
        image_set_text(im, CRYPTOMATTE_SAMPLES_OF, text);
    for (int i = 0; i < KINDS; i++)
        if (kinds & kinds_known[i].bit && !add_layer(job, &kinds_known[i], samples, im))
            return false;
    return true;
}
