// SPDX-License-Identifier: Apache-2.0
#include "table/goniometer.h"

#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "table/goniometer_reader.h"

enum { MOST_BYTES = 256 << 20 };

float (*gonio_alloc(const struct goniometer_table *t, struct arena *arena))[3] {
    const size_t nodes = (size_t)t->theta_count * (size_t)t->phi_count * goniometer_slice(t);
    return arena_alloc(arena, nodes * sizeof(float[3]));
}

// ---- holes ----------------------------------------------------------------------------------

// Mean of a node's valid neighbours; false: there is none.
static bool node_mean(const float (*f)[3], int thetas, int phis, int node, float mean[3]) {
    const int i = node / phis, j = node % phis;
    const int around[4][2] = {{i, (j + 1) % phis}, {i, (j + phis - 1) % phis}, {i - 1, j},
                              {i + 1, j}};
    float sum[3] = {0};
    int count = 0;
    for (int k = 0; k < 4; k++) {
        if (around[k][0] < 0 || around[k][0] >= thetas)
            continue;
        const float *v = f[around[k][0] * phis + around[k][1]];
        count += v[0] >= 0;
        for (int c = 0; c < 3 && v[0] >= 0; c++)
            sum[c] += v[c];
    }
    for (int c = 0; c < 3 && count; c++)
        mean[c] = sum[c] / (float)count;
    return count > 0;
}

// One slice, in rounds; where nothing is valid it becomes black.
static void fill_slice(float (*f)[3], int thetas, int phis) {
    const int n = thetas * phis;
    float(*next)[3] = mem_array((size_t)n, sizeof *next);
    for (bool changed = true; changed;) {
        changed = false;
        memcpy(next, f, (size_t)n * sizeof *next);
        for (int k = 0; k < n; k++)
            if (!(f[k][0] >= 0) && node_mean(f, thetas, phis, k, next[k]))
                changed = true;
        memcpy(f, next, (size_t)n * sizeof *next);
    }
    for (int k = 0; k < n; k++)
        if (!(f[k][0] >= 0))
            memset(f[k], 0, sizeof f[k]);
    mem_free(next);
}

void gonio_fill(struct goniometer_table *t) {
    const size_t incident = (size_t)t->theta_count * (size_t)t->phi_count;
    for (int side = 0; side < 2; side++)
        for (size_t k = 0; t->f[side] && k < incident; k++)
            fill_slice(t->f[side] + k * goniometer_slice(t), t->out_thetas, t->out_phis);
}

// ---- looking up -----------------------------------------------------------------------------

spectrum goniometer_look(const struct goniometer_table *t, int side, size_t incident, vec3 out) {
    const float(*f)[3] = t->f[side] + incident * goniometer_slice(t);
    const float theta = atan2f(sqrtf(out[0] * out[0] + out[1] * out[1]), out[2]);
    const float turns = atan2f(out[1], out[0]) * (1 / TWO_PI);
    const float x = (turns < 0 ? turns + 1 : turns) * (float)t->out_phis;
    const float y = clampf(theta * (2 / PI), 0, 1) * (float)(t->out_thetas - 1);
    const int i = y >= (float)(t->out_thetas - 1) ? t->out_thetas - 2 : (int)y;
    const int j = (int)x % t->out_phis, next = (j + 1) % t->out_phis;
    const float fx = x - floorf(x), fy = y - (float)i;
    spectrum sum = spectrum_grey(0);
    for (int k = 0; k < 4; k++) {
        const float *v = f[(i + (k >> 1)) * t->out_phis + (k & 1 ? next : j)];
        const float weight = (k & 1 ? fx : 1 - fx) * (k >> 1 ? fy : 1 - fy);
        sum += weight * spectrum_rgb(v[0], v[1], v[2]);
    }
    return sum;
}

// ---- mirrored or sent back ------------------------------------------------------------------

static vec3 direction(float theta, float phi) {
    return v3(sinf(theta) * cosf(phi), sinf(theta) * sinf(phi), cosf(theta));
}

static bool is_retro(const struct goniometer_table *t) {
    float mirrored = 0, back = 0;
    for (int p = 0; p < t->phi_count; p++)
        for (int i = 0; i < t->theta_count; i++) {
            const size_t incident = (size_t)(p * t->theta_count + i);
            if (t->theta[i] < 0.1f) // the two lobes are one
                continue;
            mirrored += spectrum_mean(
                goniometer_look(t, 0, incident, direction(t->theta[i], t->phi[p] + PI)));
            back += spectrum_mean(goniometer_look(t, 0, incident, direction(t->theta[i], t->phi[p])));
        }
    return back > 2 * mirrored;
}

// Turns all outgoing azimuths by pi.
static void turn_azimuths(struct goniometer_table *t, int side) {
    const size_t rows = (size_t)t->theta_count * (size_t)t->phi_count * (size_t)t->out_thetas;
    const size_t half = (size_t)t->out_phis / 2;
    for (size_t r = 0; t->f[side] && r < rows; r++)
        for (size_t j = 0; j < half; j++) {
            float *a = t->f[side][r * (size_t)t->out_phis + j], *b = a + 3 * half, keep[3];
            memcpy(keep, a, sizeof keep);
            memcpy(a, b, sizeof keep);
            memcpy(b, keep, sizeof keep);
        }
}

// ---- reading --------------------------------------------------------------------------------

typedef bool (*reader_fn)(const char *path, char *text, struct goniometer_table *t,
                          struct arena *arena);

static reader_fn reader_for(const char *path) {
    static const struct {
        const char *extension;
        reader_fn read;
    } readers[] = {{"brdf", cornell_read}, {"dat", alta_read}, {"transfer", transfer_read}};
    char extension[16];
    file_extension(path, extension, sizeof extension);
    for (size_t i = 0; i < sizeof readers / sizeof *readers; i++)
        if (strcmp(extension, readers[i].extension) == 0)
            return readers[i].read;
    log_error("%s: is not a goniometer table; expected .brdf (Cornell), .dat (ALTA) or .transfer",
              path);
    return NULL;
}

struct goniometer_table *goniometer_read(const char *path, enum goniometer_lobe lobe,
                                         struct arena *arena) {
    const reader_fn read = reader_for(path);
    size_t size;
    char *text = read ? file_read(path, MOST_BYTES, &size) : NULL;
    struct goniometer_table *t = arena_alloc(arena, sizeof *t);
    const bool good = text && read(path, text, t, arena);
    mem_free(text);
    if (!good)
        return NULL;
    gonio_fill(t);
    t->retro = lobe == GONIOMETER_RETRO || (lobe == GONIOMETER_AUTO && is_retro(t));
    if (t->retro)
        turn_azimuths(t, 0);
    if (t->invalid)
        log_warn("%s: %zu samples are missing, negative or no numbers; their neighbours stand in",
                 path, t->invalid);
    return t;
}
