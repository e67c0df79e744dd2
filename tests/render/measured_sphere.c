// SPDX-License-Identifier: Apache-2.0
// A sphere of ten measured materials (MERL tables made of networks) in the light of Grace cathedral,
// against brute force: the sum over the probe's texels of radiance times table, looked up by a
// second program in double precision. Needs the shared data.
//
// The camera sees one point of the sphere, at three angles: 30 pictures of one pixel with 2^17
// samples, each within 0.5 % of the sum in each channel. Standard errors are below 0.1 %. The short
// mode takes three of the materials, at one angle each.
#include "check.h"
#include "merl_lookup.h"
#include "nbrdf.h"
#include "render/picture.h"

static const char scene[] =
    "<scene version='3.0.0'>"
    "<integrator type='direct'><integer name='bsdf_samples' value='1'/></integrator>"
    "<emitter type='envmap'><string name='filename' value='%s'/></emitter>"
    "<shape type='sphere'><bsdf type='merl'><string name='filename' value='%s'/></bsdf></shape>"
    "<sensor type='orthographic'><transform name='to_world'><scale x='1e-4' y='1e-4'/>"
    "<lookat origin='%.9g, 0, %.9g' target='%.9g, 0, %.9g' up='0, 1, 0'/></transform>"
    "<film type='hdrfilm'><integer name='width' value='1'/><integer name='height' value='1'/>"
    "<rfilter type='box'/></film></sensor></scene>";

// Radiance of the probe in the way of the light `envmap`: bilinear, first and last row at the
// poles; u runs once around from -z over +x.
static void probe_at(const struct image *im, double u, double v, double rgb[3]) {
    const double x = u * im->width - 0.5, y = v * (im->height - 1);
    const int ix = (int)floor(x), iy = (int)fmin(y, im->height - 2);
    for (int c = 0; c < 3; c++) {
        rgb[c] = 0;
        for (int k = 0; k < 4; k++) {
            const int px = (ix + (k & 1) + im->width) % im->width, py = iy + (k >> 1);
            const double w = (k & 1 ? x - ix : 1 - x + ix) * (k >> 1 ? y - iy : 1 - y + iy);
            rgb[c] += w * (double)im->pixels[((size_t)py * (size_t)im->width + (size_t)px) *
                                             (size_t)im->channels + (size_t)c];
        }
    }
}

// What arrives from one texel of the probe at the point with normal and local z = world z, local
// x = world x, seen from wo; steps x steps points.
static void add_texel(const struct image *probe, const float (*rgb)[3], const double wo[3],
                      int texel, int steps, double sum[3]) {
    const double area = M_PI / probe->height / steps * 2 * M_PI / probe->width / steps;
    for (int k = 0; k < steps * steps; k++) {
        const double v = (texel / probe->width + (k / steps + 0.5) / steps) / probe->height;
        const double u = (texel % probe->width + (k % steps + 0.5) / steps) / probe->width;
        const double sine = sin(M_PI * v), turn = 2 * M_PI * u;
        const double w[3] = {sin(turn) * sine, cos(M_PI * v), -cos(turn) * sine};
        double f[3], light[3];
        if (!(w[2] > 0))
            continue;
        lookup_merl(rgb, w, wo, f);
        probe_at(probe, u, v, light);
        for (int c = 0; c < 3; c++)
            sum[c] += f[c] * light[c] * w[2] * sine * area;
    }
}

// Texels near the mirror direction are divided finely: peaks are narrower than they are.
static void brute_force(const struct image *probe, const float (*rgb)[3], double angle,
                        double sum[3]) {
    const double wo[3] = {sin(angle), 0, cos(angle)};
    sum[0] = sum[1] = sum[2] = 0;
    for (int i = 0; i < probe->width * probe->height; i++) {
        const double v = (i / probe->width + 0.5) / probe->height;
        const double turn = 2 * M_PI * (i % probe->width + 0.5) / probe->width;
        const double cosine = -sin(turn) * sin(M_PI * v) * wo[0] - cos(turn) * sin(M_PI * v) * wo[2];
        add_texel(probe, rgb, wo, i, cosine > 0.97 ? 8 : 1, sum);
    }
}

static void render_point(const char *probe, const char *table, double angle, double rgb[3]) {
    char text[8192];
    struct image im;
    struct render_result result;
    const struct job_options options = {.spp = 1 << 17, .threads = 2, .seed = 1};
    snprintf(text, sizeof text, scene, probe, table, 10 * sin(angle), 1 + 10 * cos(angle), 0.0,
             1.0);
    render_text(text, &options, &im, &result);
    for (int c = 0; c < 3; c++)
        rgb[c] = (double)im.pixels[c];
    image_finish(&im);
}

int main(void) {
    static const int materials[10] = {0, 2, 9, 21, 33, 46, 58, 70, 83, 97};
    static const double degrees[3] = {15, 45, 70};
    const char *shared = getenv("RELUME_SHARED_DATA");
    char probe_path[4096], table_path[256];
    struct nbrdf network;
    struct image probe;
    double worst = 0;
    if (!shared)
        return 77;
    scene_folder_open();
    snprintf(probe_path, sizeof probe_path, "%s/env/debevec/grace_probe_latlong.hdr", shared);
    snprintf(table_path, sizeof table_path, "%s", scene_path("table.binary"));
    if (!image_read(probe_path, &probe))
        return 1;
    for (int m = 0; m < 10 && nbrdf_load(materials[m], &network); m++) {
        if (!full_mode() && m % 4)
            continue;
        float(*table)[3] = nbrdf_table(&network);
        CHECK(merl_write(table_path, table));
        for (int a = 0; a < 3; a++) {
            if (!full_mode() && a != m % 3)
                continue;
            double expected[3], found[3];
            brute_force(&probe, table, degrees[a] * M_PI / 180, expected);
            render_point(probe_path, table_path, degrees[a] * M_PI / 180, found);
            printf("material %2d at %g degrees: %.5f %.5f %.5f, expected %.5f %.5f %.5f\n",
                   materials[m], degrees[a], found[0], found[1], found[2], expected[0],
                   expected[1], expected[2]);
            for (int c = 0; c < 3; c++) {
                worst = fmax(worst, fabs(found[c] / expected[c] - 1));
                CHECK_NEAR(found[c], expected[c], 5e-3 * expected[c]);
            }
        }
        mem_free(table);
    }
    printf("largest relative difference: %.2g\n", worst);
    image_finish(&probe);
    scene_folder_close();
    return check_result();
}
