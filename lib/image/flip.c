// SPDX-License-Identifier: Apache-2.0
#include "image/flip.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "base/thread.h"
#include "image/flip_colour.h"
#include "image/flip_kernel.h"

// Planes after the horizontal pass.
enum { CSF_Y, CSF_CX, CSF_CZ1, CSF_CZ2, GAUSS, EDGE, POINT, PLANES };

struct flip {
    const struct image *pictures[2]; // reference, test
    float *planes[2][PLANES];
    float *scratch; // per worker
    size_t scratch_size;
    struct flip_kernels kernels;
    float colour_max; // the largest colour difference, to the power 0.7
    int width, height;
    float *map;
    double *row_sums;
};

static float clip(float v) {
    return v > 0 ? (v < 1 ? v : 1) : 0;
}

// out[x] = sum of weights * in[x + i]; `in` has radius values before and after the line.
static void filter_line(const struct flip_kernel *k, const float *in, int width, float *out) {
    memset(out, 0, (size_t)width * sizeof *out);
    for (int i = -k->radius; i <= k->radius; i++) {
        const float w = k->weight[i + k->radius];
        for (int x = 0; x < width; x++)
            out[x] += w * in[x + i];
    }
}

// The picture continues beyond its edges with the values at the edge.
static void pad(float *line, int width) {
    for (int i = 1; i <= FLIP_MOST_RADIUS; i++) {
        line[-i] = line[0];
        line[width - 1 + i] = line[width - 1];
    }
}

static void horizontal_pass(void *ctx, size_t item, int worker) {
    struct flip *f = ctx;
    const size_t row = item / 2, pad_size = FLIP_MOST_RADIUS;
    const int which = (int)(item % 2), width = f->width;
    const size_t stride = (size_t)width + 2 * pad_size;
    float *line[4];
    for (size_t i = 0; i < 4; i++)
        line[i] = f->scratch + (size_t)worker * f->scratch_size + i * stride + pad_size;
    const float *in = f->pictures[which]->pixels + row * (size_t)width * 3;
    for (int x = 0; x < width; x++) {
        const float rgb[3] = {clip(in[3 * x]), clip(in[3 * x + 1]), clip(in[3 * x + 2])};
        float c[3];
        flip_rgb_to_ycxcz(rgb, c);
        line[0][x] = c[0];
        line[1][x] = c[1];
        line[2][x] = c[2];
        line[3][x] = (c[0] + 16) / 116; // luminance 0..1, in which features are sought
    }
    for (int i = 0; i < 4; i++)
        pad(line[i], width);
    const struct flip_kernel *kernels[PLANES] = {
        &f->kernels.csf_y, &f->kernels.csf_cx, &f->kernels.csf_cz1, &f->kernels.csf_cz2,
        &f->kernels.gauss, &f->kernels.edge,   &f->kernels.point};
    static const int source[PLANES] = {0, 1, 2, 2, 3, 3, 3};
    for (int p = 0; p < PLANES; p++)
        filter_line(kernels[p], line[source[p]], width,
                    f->planes[which][p] + row * (size_t)width);
}

// One line of the vertical pass; rows beyond the edge repeat it. Adds to out.
static void filter_column(const struct flip *f, const struct flip_kernel *k, const float *plane,
                          int row, float *out) {
    for (int i = -k->radius; i <= k->radius; i++) {
        const int y = row + i < 0 ? 0 : row + i >= f->height ? f->height - 1 : row + i;
        const float w = k->weight[i + k->radius], *in = plane + (size_t)y * (size_t)f->width;
        for (int x = 0; x < f->width; x++)
            out[x] += w * in[x];
    }
}

// Equations 10 and 11: compresses large colour differences, range 0..1.
static float colour_difference(const struct flip *f, const float lab_a[3], const float lab_b[3]) {
    const float v = powf(flip_hyab(lab_a, lab_b), 0.7f), knee = 0.4f * f->colour_max;
    if (v < knee)
        return 0.95f / knee * v;
    return 0.95f + (v - knee) / (f->colour_max - knee) * 0.05f;
}

// The filtered lines of one picture at a row.
struct filtered {
    float *y, *cx, *cz, *edge_x, *edge_y, *point_x, *point_y;
};

static void vertical_pass(const struct flip *f, int which, int row, struct filtered *out,
                          float *memory) {
    const size_t w = (size_t)f->width;
    *out = (struct filtered){memory,         memory + w,     memory + 2 * w, memory + 3 * w,
                             memory + 4 * w, memory + 5 * w, memory + 6 * w};
    memset(memory, 0, 7 * w * sizeof *memory);
    float *const *p = f->planes[which];
    const struct flip_kernels *k = &f->kernels;
    filter_column(f, &k->csf_y, p[CSF_Y], row, out->y);
    filter_column(f, &k->csf_cx, p[CSF_CX], row, out->cx);
    filter_column(f, &k->csf_cz1, p[CSF_CZ1], row, out->cz);
    filter_column(f, &k->csf_cz2, p[CSF_CZ2], row, out->cz);
    filter_column(f, &k->gauss, p[EDGE], row, out->edge_x);
    filter_column(f, &k->edge, p[GAUSS], row, out->edge_y);
    filter_column(f, &k->gauss, p[POINT], row, out->point_x);
    filter_column(f, &k->point, p[GAUSS], row, out->point_y);
}

static void filtered_lab(const struct filtered *in, int x, float lab[3]) {
    const float c[3] = {in->y[x], in->cx[x], in->cz[x]};
    float rgb[3];
    flip_ycxcz_to_rgb(c, rgb);
    for (int i = 0; i < 3; i++)
        rgb[i] = clip(rgb[i]);
    flip_rgb_to_hunt_lab(rgb, lab);
}

static float length(float x, float y) {
    return sqrtf(x * x + y * y);
}

static void combine_row(void *ctx, size_t row, int worker) {
    struct flip *f = ctx;
    float *memory = f->scratch + (size_t)worker * f->scratch_size;
    struct filtered a, b;
    vertical_pass(f, 0, (int)row, &a, memory);
    vertical_pass(f, 1, (int)row, &b, memory + 7 * (size_t)f->width);
    double sum = 0;
    for (int x = 0; x < f->width; x++) {
        float lab_a[3], lab_b[3];
        filtered_lab(&a, x, lab_a);
        filtered_lab(&b, x, lab_b);
        const float colour = colour_difference(f, lab_a, lab_b);
        const float edge = fabsf(length(a.edge_x[x], a.edge_y[x]) - length(b.edge_x[x], b.edge_y[x]));
        const float point =
            fabsf(length(a.point_x[x], a.point_y[x]) - length(b.point_x[x], b.point_y[x]));
        const float feature = sqrtf(fmaxf(edge, point) * 0.70710678f); // equation 13
        const float v = clip(powf(colour, 1 - clip(feature)));         // equation 14
        f->map[row * (size_t)f->width + (size_t)x] = v;
        sum += (double)v;
    }
    f->row_sums[row] = sum;
}

// The largest colour difference there is: between the green and the blue of Rec.709.
static float largest_difference(void) {
    const float green[3] = {0, 1, 0}, blue[3] = {0, 0, 1};
    float a[3], b[3];
    flip_rgb_to_hunt_lab(green, a);
    flip_rgb_to_hunt_lab(blue, b);
    return powf(flip_hyab(a, b), 0.7f);
}

double flip_ldr(const struct image *ref, const struct image *test, double pixels_per_degree,
                int threads, struct image *map) {
    const size_t w = (size_t)ref->width, h = (size_t)ref->height;
    threads = threads > 0 ? threads : thread_default_count();
    struct flip *f = mem_array(1, sizeof *f);
    *f = (struct flip){.pictures = {ref, test}, .width = ref->width, .height = ref->height};
    f->colour_max = largest_difference();
    flip_make_kernels(&f->kernels, pixels_per_degree);
    f->scratch_size = 14 * w + 8 * FLIP_MOST_RADIUS;
    f->scratch = mem_array((size_t)threads, f->scratch_size * sizeof *f->scratch);
    for (int i = 0; i < 2 * PLANES; i++)
        f->planes[i / PLANES][i % PLANES] = mem_array(w * h, sizeof(float));
    f->map = mem_array(w * h, sizeof *f->map);
    f->row_sums = mem_array(h, sizeof *f->row_sums);
    thread_for(threads, 2 * h, horizontal_pass, f);
    thread_for(threads, h, combine_row, f);
    double sum = 0;
    for (size_t y = 0; y < h; y++)
        sum += f->row_sums[y];
    if (map && image_init(map, ref->width, ref->height, 1))
        memcpy(map->pixels, f->map, w * h * sizeof(float));
    for (int i = 0; i < 2 * PLANES; i++)
        mem_free(f->planes[i / PLANES][i % PLANES]);
    mem_free(f->scratch);
    mem_free(f->map);
    mem_free(f->row_sums);
    mem_free(f);
    return sum / (double)(w * h);
}
