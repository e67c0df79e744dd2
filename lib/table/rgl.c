// SPDX-License-Identifier: Apache-2.0
#include "table/rgl.h"

#include <math.h>
#include <string.h>

#include "base/log.h"
#include "math/colour.h"
#include "table/tensor_file.h"

static const float LARGEST = 1e12f; // what lies beyond is damage; keeps products in range

// A field as aligned floats. Values that cannot be are counted and become 0; colours of few units
// below zero can be (they lie outside of the gamut).
static float *load(const struct tensor_field *f, bool colour, struct rgl_table *t,
                   struct arena *arena) {
    float *v = arena_alloc(arena, f->count * sizeof *v);
    memcpy(v, f->data, f->count * sizeof *v);
    for (size_t i = 0; i < f->count; i++)
        if (!(v[i] >= (colour ? -LARGEST : 0)) || v[i] > LARGEST) {
            v[i] = 0;
            t->invalid++;
        }
    return v;
}

static bool ascends(const float *v, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!isfinite(v[i]) || fabsf(v[i]) > 10 || (i > 0 && !(v[i] > v[i - 1])))
            return false;
    return true;
}

static const float *load_angles(const struct tensor_file *file, const char *name, int *count,
                                struct arena *arena) {
    const struct tensor_field *f = tensor_field_need(file, name, TENSOR_F32, 1);
    if (!f)
        return NULL;
    float *v = arena_alloc(arena, f->count * sizeof *v);
    memcpy(v, f->data, f->count * sizeof *v);
    *count = (int)f->count;
    if (ascends(v, f->count))
        return v;
    log_error("%s: \"%s\" is not an ascending list of angles", file->path, name);
    return NULL;
}

// A picture, or a stack of them for every incident direction.
static const float *load_maps(const struct tensor_file *file, const char *name, bool stack,
                              struct rgl_table *t, int size[2], struct arena *arena) {
    const struct tensor_field *f = tensor_field_need(file, name, TENSOR_F32, stack ? 4 : 2);
    if (!f)
        return NULL;
    const size_t *last = f->shape + f->dimensions - 2;
    if (last[0] < 2 || last[1] < 2 ||
        (stack && (f->shape[0] != (size_t)t->phi_count || f->shape[1] != (size_t)t->theta_count))) {
        log_error("%s: \"%s\" does not have the shape that the incident directions ask for",
                  file->path, name);
        return NULL;
    }
    size[0] = (int)last[0];
    size[1] = (int)last[1];
    return load(f, false, t, arena);
}

// Weights that turn a spectrum at these wavelengths into Rec.709: the colours of its hats.
static float (*colour_weights(const float *wavelengths, size_t count))[3] {
    double *x = mem_array(count, sizeof *x), *y = mem_array(count, sizeof *y);
    float(*w)[3] = mem_array(count, sizeof *w);
    for (size_t i = 0; i < count; i++)
        x[i] = (double)wavelengths[i];
    for (size_t i = 0; i < count; i++) {
        y[i] = 1;
        const spectrum c = colour_from_samples(x, y, count, true);
        y[i] = 0;
        for (int k = 0; k < 3; k++)
            w[i][k] = c[k];
    }
    mem_free(x);
    mem_free(y);
    return w;
}

static float *spectra_to_rgb(const float *spectra, const float *wavelengths, size_t count,
                             size_t directions, size_t texels, struct arena *arena) {
    float *rgb = arena_alloc(arena, directions * 3 * texels * sizeof *rgb);
    float(*w)[3] = colour_weights(wavelengths, count);
    for (size_t d = 0; d < directions; d++)
        for (size_t i = 0; i < count; i++)
            for (size_t c = 0; c < 3; c++)
                for (size_t p = 0; p < texels; p++)
                    rgb[(d * 3 + c) * texels + p] +=
                        w[i][c] * spectra[(d * count + i) * texels + p];
    mem_free(w);
    return rgb;
}

static bool ascending_wavelengths(const float *v, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!(v[i] > 0) || !(v[i] < 1e5f) || (i > 0 && !(v[i] > v[i - 1])))
            return false;
    return true;
}

static bool load_colours(const struct tensor_file *file, struct rgl_table *t, struct arena *arena) {
    t->spectral = !tensor_has_field(file, "rgb");
    const struct tensor_field *f =
        tensor_field_need(file, t->spectral ? "spectra" : "rgb", TENSOR_F32, 5);
    const struct tensor_field *w =
        t->spectral ? tensor_field_need(file, "wavelengths", TENSOR_F32, 1) : NULL;
    if (!f || (t->spectral && !w))
        return false;
    const size_t channels = t->spectral ? w->count : 3;
    const size_t directions = (size_t)t->phi_count * (size_t)t->theta_count;
    if (f->shape[0] * f->shape[1] != directions || f->shape[1] != (size_t)t->theta_count ||
        f->shape[2] != channels || f->shape[3] != (size_t)t->size[0] ||
        f->shape[4] != (size_t)t->size[1]) {
        log_error("%s: \"%s\" does not have the shape of \"luminance\"", file->path, f->name);
        return false;
    }
    float *values = load(f, true, t, arena);
    t->rgb = values;
    if (!t->spectral)
        return true;
    float *wavelengths = arena_alloc(arena, w->count * sizeof *wavelengths);
    memcpy(wavelengths, w->data, w->count * sizeof *wavelengths);
    if (!ascending_wavelengths(wavelengths, w->count)) {
        log_error("%s: \"wavelengths\" is not an ascending list of nm", file->path);
        return false;
    }
    t->rgb = spectra_to_rgb(values, wavelengths, channels, directions,
                            f->shape[3] * f->shape[4], arena);
    return true;
}

static bool load_all(const struct tensor_file *file, struct rgl_table *t, struct arena *arena) {
    t->phi = load_angles(file, "phi_i", &t->phi_count, arena);
    t->theta = t->phi ? load_angles(file, "theta_i", &t->theta_count, arena) : NULL;
    if (!t->theta)
        return false;
    t->ndf = load_maps(file, "ndf", false, t, t->ndf_size, arena);
    t->sigma = t->ndf ? load_maps(file, "sigma", false, t, t->sigma_size, arena) : NULL;
    t->vndf = t->sigma ? load_maps(file, "vndf", true, t, t->vndf_size, arena) : NULL;
    t->luminance = t->vndf ? load_maps(file, "luminance", true, t, t->size, arena) : NULL;
    const struct tensor_field *j =
        t->luminance ? tensor_field_need(file, "jacobian", TENSOR_U8, 1) : NULL;
    if (!j || !load_colours(file, t, arena))
        return false;
    t->jacobian = j->data[0] != 0;
    t->isotropic = t->phi_count <= 2;
    t->reduction = 1;
    if (!t->isotropic)
        t->reduction = (int)lrintf(TWO_PI / (t->phi[t->phi_count - 1] - t->phi[0]));
    const struct tensor_field *d = NULL;
    if (tensor_has_field(file, "description"))
        d = tensor_field_need(file, "description", TENSOR_U8, 1);
    t->description = d ? arena_printf(arena, "%.*s", (int)d->count, (const char *)d->data) : "";
    return true;
}

struct rgl_table *rgl_read(const char *path, struct arena *arena) {
    struct tensor_file file;
    if (!tensor_file_read(path, &file))
        return NULL;
    struct rgl_table *t = arena_alloc(arena, sizeof *t);
    const bool good = load_all(&file, t, arena);
    tensor_file_finish(&file);
    if (good && t->invalid)
        log_warn("%s: %zu values are negative or no numbers; taken as 0", path, t->invalid);
    return good ? t : NULL;
}
