// SPDX-License-Identifier: Apache-2.0
#include "driver/merge_matte.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "driver/cryptomatte.h"
#include "sink/matte.h"

struct part {
    struct image im;
    unsigned seed;
    uint64_t first, samples;
};

// The names of a layer by id, for putting equal shares into the order of one run.
struct place {
    uint32_t id, order;
};

struct layer {
    char name[IMAGE_NAME_SIZE];
    struct place *places; // by id
    size_t place_count;
};

// What covers a pixel.
struct share {
    uint32_t id, order;
    double samples;
};

static bool read_part(const char *path, struct part *p) {
    char picture[4096];
    const size_t n = strlen(path), end = strlen(".journal");
    const bool is_journal = n > end && strcmp(path + n - end, ".journal") == 0;
    snprintf(picture, sizeof picture, "%.*s", (int)(is_journal ? n - end : n), path);
    if (!file_exists(picture))
        return true;
    if (!image_read(picture, &p->im))
        return false;
    const struct image_attribute *a = image_find_attribute(&p->im, CRYPTOMATTE_SAMPLES_OF);
    if (!a || !a->text ||
        sscanf(a->text, "%u %" SCNu64 " %" SCNu64, &p->seed, &p->first, &p->samples) != 3)
        p->samples = 0;
    return true;
}

static int by_samples(const void *a, const void *b) {
    const struct part *x = a, *y = b;
    if (x->seed != y->seed)
        return x->seed < y->seed ? -1 : 1;
    return (x->first > y->first) - (x->first < y->first);
}

static int by_id(const void *a, const void *b) {
    const struct place *x = a, *y = b;
    return (x->id > y->id) - (x->id < y->id);
}

static int by_share(const void *a, const void *b) {
    const struct share *x = a, *y = b;
    if (x->samples != y->samples)
        return x->samples < y->samples ? 1 : -1;
    return (x->order > y->order) - (x->order < y->order);
}

static void read_manifest(const struct image *im, struct layer *l) {
    char key[IMAGE_NAME_SIZE];
    cryptomatte_key(l->name, "manifest", key);
    const struct image_attribute *a = image_find_attribute(im, key);
    struct json *manifest = a && a->text ? json_parse(a->text, strlen(a->text), key) : NULL;
    l->places = mem_array(json_count(manifest) + 1, sizeof *l->places);
    for (size_t i = 0; i < json_count(manifest); i++) {
        const char *hash = json_text(json_get(manifest, json_key(manifest, i)));
        l->places[l->place_count++] =
            (struct place){hash ? (uint32_t)strtoul(hash, NULL, 16) : 0, (uint32_t)i};
    }
    qsort(l->places, l->place_count, sizeof *l->places, by_id);
    json_destroy(manifest);
}

static uint32_t order_of(const struct layer *l, uint32_t id) {
    const struct place *p =
        bsearch(&(struct place){.id = id}, l->places, l->place_count, sizeof *l->places, by_id);
    return p ? p->order : UINT32_MAX;
}

static int first_channel(const struct image *im, const char *layer) {
    char name[IMAGE_NAME_SIZE + 8];
    snprintf(name, sizeof name, "%s00.R", layer);
    return image_find_channel(im, name);
}

// Channels of a rank of a layer, whose order in a file is that of their names.
static void rank_channels(const struct image *im, const char *layer, int rank, int out[2]) {
    static const char channels[4] = {'R', 'G', 'B', 'A'};
    char name[IMAGE_NAME_SIZE + 8];
    for (int k = 0; k < 2; k++) {
        snprintf(name, sizeof name, "%s%02d.%c", layer, rank / 2, channels[rank % 2 * 2 + k]);
        out[k] = image_find_channel(im, name);
    }
}

// The part's pixel at a place of the whole picture, or NULL.
static const float *pixel_of(const struct image *im, int x, int y) {
    x -= im->full_width ? im->crop_x : 0;
    y -= im->full_width ? im->crop_y : 0;
    if (x < 0 || y < 0 || x >= im->width || y >= im->height)
        return NULL;
    return im->pixels + ((size_t)y * (size_t)im->width + (size_t)x) * (size_t)im->channels;
}

// Adds the ranks of a part's pixel to the shares; returns how many there are then.
static size_t add_ranks(const struct layer *l, const struct part *p, const float *pixel,
                        struct share *shares, size_t count) {
    for (int r = 0; r < MATTE_RANKS; r++) {
        int channel[2];
        uint32_t id;
        rank_channels(&p->im, l->name, r, channel);
        if (channel[0] < 0 || channel[1] < 0 || !(pixel[channel[1]] > 0))
            continue;
        memcpy(&id, &pixel[channel[0]], sizeof id);
        size_t i = 0;
        while (i < count && shares[i].id != id)
            i++;
        if (i == count)
            shares[count++] = (struct share){.id = id, .order = order_of(l, id)};
        shares[i].samples += (double)pixel[channel[1]] * (double)p->samples;
    }
    return count;
}

static void merge_pixel(const struct layer *l, const struct part *parts, size_t count, int x, int y,
                        struct share *shares, float *out) {
    double samples = 0;
    size_t names = 0;
    for (size_t i = 0; i < count && samples < CRYPTOMATTE_SAMPLES; i++) {
        const float *pixel = pixel_of(&parts[i].im, x, y);
        if (!pixel)
            continue;
        names = add_ranks(l, &parts[i], pixel, shares, names);
        samples += (double)parts[i].samples;
    }
    qsort(shares, names, sizeof *shares, by_share);
    for (size_t r = 0; r < names && r < MATTE_RANKS; r++) {
        memcpy(&out[2 * r], &shares[r].id, sizeof out[0]);
        out[2 * r + 1] = (float)(shares[r].samples / samples);
    }
}

static void merge_layer(struct layer *l, const struct part *parts, size_t count, struct image *im) {
    const int first = im->channels;
    struct share *shares = mem_array(count * MATTE_RANKS, sizeof *shares);
    read_manifest(&parts[0].im, l);
    cryptomatte_add_channels(im, l->name);
    for (int y = 0; y < im->height; y++)
        for (int x = 0; x < im->width; x++) {
            float *out = im->pixels +
                         ((size_t)y * (size_t)im->width + (size_t)x) * (size_t)im->channels + first;
            merge_pixel(l, parts, count, x + (im->full_width ? im->crop_x : 0),
                        y + (im->full_width ? im->crop_y : 0), shares, out);
        }
    mem_free(shares);
    mem_free(l->places);
}

// The samples that the union's layers are of, and what tells compositors of them.
static void add_attributes(const struct part *parts, size_t count, struct image *im) {
    char text[64];
    uint64_t samples = 0;
    for (size_t i = 0; i < count && samples < CRYPTOMATTE_SAMPLES; i++)
        samples += parts[i].samples;
    snprintf(text, sizeof text, "%u %" PRIu64 " %" PRIu64, parts[0].seed, parts[0].first,
             im->full_width ? parts[0].samples : samples);
    image_set_text(im, CRYPTOMATTE_SAMPLES_OF, text);
    for (int i = 0; i < parts[0].im.attribute_count; i++) {
        const struct image_attribute *a = &parts[0].im.attributes[i];
        if (strncmp(a->name, "cryptomatte/", 12) == 0 && a->text)
            image_set_text(im, a->name, a->text);
    }
}

static void merge_all(const struct part *parts, size_t count, struct image *im) {
    for (int c = 0; c < parts[0].im.channels; c++) {
        struct layer l = {.places = NULL};
        const char *name = parts[0].im.channel_names[c];
        const size_t n = strlen(name);
        bool everywhere = n > 4 && strncmp(name, "Crypto", 6) == 0 && strcmp(name + n - 4, "00.R") == 0;
        if (!everywhere)
            continue;
        snprintf(l.name, sizeof l.name, "%.*s", (int)(n - 4), name);
        for (size_t i = 0; i < count; i++)
            everywhere &= first_channel(&parts[i].im, l.name) >= 0;
        if (everywhere)
            merge_layer(&l, parts, count, im);
        else
            log_warn("layer %s is left out: some of the pictures lack it", l.name);
    }
    add_attributes(parts, count, im);
}

bool merge_mattes(const char *const *paths, size_t count, struct image *im) {
    struct part *parts = mem_array(count, sizeof *parts);
    const char *without = NULL, *with = NULL;
    bool sound = true;
    for (size_t i = 0; i < count && sound; i++) {
        sound = read_part(paths[i], &parts[i]);
        *(parts[i].samples ? &with : &without) = paths[i];
    }
    if (sound && with && without) {
        log_warn("Cryptomatte layers are left out: %s has them, %s has not", with, without);
    } else if (sound && with) {
        qsort(parts, count, sizeof *parts, by_samples);
        merge_all(parts, count, im);
    }
    for (size_t i = 0; i < count; i++)
        image_finish(&parts[i].im);
    mem_free(parts);
    return sound;
}
