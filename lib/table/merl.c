// SPDX-License-Identifier: Apache-2.0
#include "table/merl.h"

#include <stdint.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"

static const double scales[3] = {1.0 / 1500, 1.15 / 1500, 1.66 / 1500};
static const float LARGEST = 1e12f; // what lies beyond is damage; keeps products in range

enum { HEADER = 12, FILE_BYTES = HEADER + 3 * MERL_CELLS * 8 };

static bool is_valid(const float rgb[3]) {
    for (int c = 0; c < 3; c++)
        if (!(rgb[c] >= 0) || rgb[c] > LARGEST)
            return false;
    return true;
}

void merl_directions(int theta_h, int theta_d, int phi_d, vec3 *wi, vec3 *wo) {
    const double u = theta_h / (double)MERL_THETA_H, radian = M_PI / 180;
    const double h = u * u * M_PI / 2, d = theta_d * radian, phi = phi_d * radian;
    const double x = sin(d) * cos(phi), y = sin(d) * sin(phi), z = cos(d);
    *wi = v3((float)(cos(h) * x + sin(h) * z), (float)y, (float)(cos(h) * z - sin(h) * x));
    *wo = v3((float)(sin(h) * z - cos(h) * x), (float)-y, (float)(cos(h) * z + sin(h) * x));
}

// ---- filling --------------------------------------------------------------------------------

// The up to six neighbours of a cell; phi_d closes upon itself.
static int neighbours(size_t cell, size_t out[6]) {
    const int k = (int)(cell % MERL_PHI_D), j = (int)(cell / MERL_PHI_D % MERL_THETA_D);
    const int i = (int)(cell / (MERL_PHI_D * MERL_THETA_D));
    int n = 0;
    out[n++] = merl_index(i, j, (k + 1) % MERL_PHI_D);
    out[n++] = merl_index(i, j, (k + MERL_PHI_D - 1) % MERL_PHI_D);
    if (j > 0)
        out[n++] = merl_index(i, j - 1, k);
    if (j < MERL_THETA_D - 1)
        out[n++] = merl_index(i, j + 1, k);
    if (i > 0)
        out[n++] = merl_index(i - 1, j, k);
    if (i < MERL_THETA_H - 1)
        out[n++] = merl_index(i + 1, j, k);
    return n;
}

// Mean of the neighbours filled before this round; false: there is none.
static bool mean_of_neighbours(const struct merl_table *t, const uint16_t *filled_in, int round,
                               size_t cell, float mean[3]) {
    size_t around[6];
    const int n = neighbours(cell, around);
    double sum[3] = {0};
    int count = 0;
    for (int i = 0; i < n; i++)
        if (filled_in[around[i]] != 0 && filled_in[around[i]] <= round) {
            count++;
            for (int c = 0; c < 3; c++)
                sum[c] += (double)t->rgb[around[i]][c];
        }
    for (int c = 0; c < 3; c++)
        mean[c] = count ? (float)(sum[c] / count) : 0;
    return count > 0;
}

// filled_in[cell]: round in which the cell got its value, 1: from the file, 0: not yet.
static void fill(struct merl_table *t, uint16_t *filled_in, size_t *open, size_t count) {
    for (int round = 1; count > 0; round++) {
        size_t left = 0;
        for (size_t i = 0; i < count; i++) {
            float mean[3];
            if (mean_of_neighbours(t, filled_in, round, open[i], mean)) {
                memcpy(t->rgb[open[i]], mean, sizeof mean);
                filled_in[open[i]] = (uint16_t)(round + 1);
            } else {
                open[left++] = open[i];
            }
        }
        if (left == count) // nothing is valid: the table is black
            break;
        count = left;
    }
}

bool merl_is_visible(vec3 wi, vec3 wo) {
    return wi[2] > 1e-4f && wo[2] > 1e-4f;
}

static bool is_visible(size_t cell) {
    vec3 wi, wo;
    merl_directions((int)(cell / (MERL_PHI_D * MERL_THETA_D)),
                    (int)(cell / MERL_PHI_D % MERL_THETA_D), (int)(cell % MERL_PHI_D), &wi, &wo);
    return merl_is_visible(wi, wo);
}

void merl_repair(struct merl_table *t) {
    uint16_t *filled_in = mem_array(MERL_CELLS, sizeof *filled_in);
    size_t *open = mem_array(MERL_CELLS, sizeof *open);
    t->invalid = t->invalid_visible = 0;
    for (size_t i = 0; i < MERL_CELLS; i++) {
        filled_in[i] = is_valid(t->rgb[i]);
        if (filled_in[i])
            continue;
        memset(t->rgb[i], 0, sizeof t->rgb[i]);
        open[t->invalid++] = i;
        t->invalid_visible += is_visible(i);
    }
    fill(t, filled_in, open, t->invalid);
    mem_free(open);
    mem_free(filled_in);
}

// ---- files ----------------------------------------------------------------------------------

static double read_double(const char *p) {
    double v;
    memcpy(&v, p, sizeof v);
    return v;
}

static bool check_header(const char *path, const char *data, size_t size) {
    int32_t n[3] = {0};
    if (size >= HEADER)
        memcpy(n, data, sizeof n);
    if (n[0] != MERL_THETA_H || n[1] != MERL_THETA_D || n[2] != MERL_PHI_D) {
        log_error("%s: is not a MERL table: it begins with %d %d %d, expected 90 90 180", path, n[0],
                  n[1], n[2]);
        return false;
    }
    if (size != FILE_BYTES)
        log_error("%s: has %zu bytes, expected %d of a MERL table", path, size, FILE_BYTES);
    return size == FILE_BYTES;
}

struct merl_table *merl_read(const char *path, struct arena *arena) {
    size_t size;
    char *data = file_read(path, 2 * (size_t)FILE_BYTES, &size);
    if (!data || !check_header(path, data, size)) {
        mem_free(data);
        return NULL;
    }
    struct merl_table *t = arena_alloc(arena, sizeof *t);
    t->rgb = arena_alloc(arena, MERL_CELLS * sizeof *t->rgb);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < MERL_CELLS; i++)
            t->rgb[i][c] = (float)(scales[c] * read_double(data + HEADER +
                                                           8 * (c * MERL_CELLS + i)));
    mem_free(data);
    merl_repair(t);
    if (t->invalid_visible)
        log_warn("%s: %zu of %d cells are invalid and filled from their neighbours, %zu of them "
                 "within sight", path, t->invalid, MERL_CELLS, t->invalid_visible);
    return t;
}

bool merl_write(const char *path, const float (*rgb)[3]) {
    const int32_t n[3] = {MERL_THETA_H, MERL_THETA_D, MERL_PHI_D};
    char *data = mem_array(FILE_BYTES, 1);
    memcpy(data, n, sizeof n);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < MERL_CELLS; i++) {
            const double v = (double)rgb[i][c] / scales[c];
            memcpy(data + HEADER + 8 * (c * MERL_CELLS + i), &v, sizeof v);
        }
    const bool good = file_write(path, data, FILE_BYTES);
    mem_free(data);
    return good;
}

// ---- looking up -----------------------------------------------------------------------------

// Rusinkiewicz' angles as positions in the table.
static void positions(vec3 wi, vec3 wo, float p[3]) {
    const vec3 h = normalize(wi + wo);
    const float across = sqrtf(h[0] * h[0] + h[1] * h[1]);
    const float theta_h = atan2f(across, h[2]);
    const float c = across > 0 ? h[0] / across : 1, s = across > 0 ? h[1] / across : 0;
    // wi in the frame of h; its third axis is h
    const float x = dot(wi, v3(h[2] * c, h[2] * s, -across)), y = wi[1] * c - wi[0] * s;
    const float theta_d = atan2f(sqrtf(x * x + y * y), dot(wi, h));
    float phi_d = atan2f(y, x);
    phi_d = phi_d < 0 ? phi_d + PI : phi_d;
    p[0] = sqrtf(theta_h * (2 / PI)) * MERL_THETA_H;
    p[1] = theta_d * (180 / PI);
    p[2] = phi_d * (180 / PI);
}

struct interval {
    int lo, hi;
    float t;
};

static struct interval clamped(float p, int count, bool nearest) {
    const int lo = p >= (float)(count - 1) ? count - 1 : (int)maxf(p, 0);
    if (nearest || lo == count - 1)
        return (struct interval){lo, lo, 0};
    return (struct interval){lo, lo + 1, maxf(p, 0) - (float)lo};
}

static struct interval periodic(float p, bool nearest) {
    const int floor_p = (int)p;
    const int lo = floor_p % MERL_PHI_D;
    return (struct interval){lo, (lo + 1) % MERL_PHI_D, nearest ? 0 : p - (float)floor_p};
}

spectrum merl_eval(const struct merl_table *t, bool nearest, vec3 wi, vec3 wo) {
    float p[3];
    positions(wi, wo, p);
    const struct interval h = clamped(p[0], MERL_THETA_H, nearest);
    const struct interval d = clamped(p[1], MERL_THETA_D, nearest);
    const struct interval f = periodic(p[2], nearest);
    spectrum sum = spectrum_grey(0);
    for (int corner = 0; corner < 8; corner++) {
        const float weight = (corner & 4 ? h.t : 1 - h.t) * (corner & 2 ? d.t : 1 - d.t) *
                             (corner & 1 ? f.t : 1 - f.t);
        if (weight == 0)
            continue;
        const float *v = t->rgb[merl_index(corner & 4 ? h.hi : h.lo, corner & 2 ? d.hi : d.lo,
                                           corner & 1 ? f.hi : f.lo)];
        sum += weight * spectrum_rgb(v[0], v[1], v[2]);
    }
    return sum;
}
