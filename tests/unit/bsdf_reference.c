// SPDX-License-Identifier: Apache-2.0
// Materials against values of Mitsuba 3 at random parameters and directions: one file a material
// named by the argument, made by tests/tools/make_bsdf_reference.py. Both compute in single
// precision: the tolerance is 1e-4 of the value and 1e-6, and 3e-7 / c^2 of it where wo and wi cancel
// nearly to a half vector under the small cosine c.
#include <string.h>

#include "check.h"
#include "make_object.h"

struct tally {
    int lines, zero;
    double worst_f, worst_pdf;
};

static struct bsdf_point flat_point(void) {
    struct bsdf_point p = {.frame = {v3(1, 0, 0), v3(0, 1, 0), v3(0, 0, 1)}};
    p.dpdu = v3(1, 0, 0);
    p.dpdv = v3(0, 1, 0);
    return p;
}

static double half_cosine(vec3 wo, vec3 wi) {
    if (wo[2] * wi[2] < 0)
        wi[2] = -wi[2];
    return 0.5 * (double)length(wo + wi);
}

// Difference in units of the tolerance.
static double misfit(double a, double b, double c) {
    return fabs(a - b) / (fmax(1e-4, 3e-7 / (c * c)) * fabs(b) + 1e-6);
}

static void check_line(const char *material, const char *line, struct tally *t) {
    char parameters[1000];
    float o[3], i[3], f[3], pdf;
    if (sscanf(line, "%999[^|]|%f %f %f |%f %f %f |%f %f %f |%f", parameters, &o[0], &o[1], &o[2],
               &i[0], &i[1], &i[2], &f[0], &f[1], &f[2], &pdf) != 11) {
        CHECK(!"a line of the table");
        return;
    }
    struct arena arena = {0};
    static struct closure_stack stack;
    const struct bsdf_point point = flat_point();
    stack.used = 0;
    const struct object *bsdf = make_bsdf(&arena, material, parameters, NULL);
    const struct closure *c = bsdf_resolve(bsdf, &point, v3_load(o), &stack);
    float our_pdf = 0;
    const spectrum ours = c ? closure_eval(c, v3_load(i), &our_pdf) : spectrum_grey(0);
    const double cosine = half_cosine(v3_load(o), v3_load(i)), top = fmax(f[0], fmax(f[1], f[2]));
    double worst_f = 0;
    for (int k = 0; k < 3; k++)
        worst_f = fmax(worst_f, misfit((double)ours[k], (double)f[k], cosine));
    const double worst_pdf = misfit((double)our_pdf, (double)pdf, cosine);
    if (!(worst_f <= 1 && worst_pdf <= 1))
        printf("%s: f %g %g %g, pdf %g\n", line, (double)ours[0], (double)ours[1],
               (double)ours[2], (double)our_pdf);
    CHECK(worst_f <= 1);
    CHECK(worst_pdf <= 1);
    t->lines++;
    t->zero += top == 0;
    t->worst_f = fmax(t->worst_f, worst_f);
    t->worst_pdf = fmax(t->worst_pdf, worst_pdf);
    arena_finish(&arena);
}

static void check_file(const char *path) {
    char line[2000], name[256];
    struct tally t = {0};
    FILE *file = fopen(path, "r");
    if (!file) {
        printf("%s cannot be read\n", path);
        CHECK(file);
        return;
    }
    const char *slash = strrchr(path, '/');
    snprintf(name, sizeof name, "%s", slash ? slash + 1 : path);
    name[strcspn(name, ".")] = '\0';
    while (fgets(line, sizeof line, file)) {
        line[strcspn(line, "\n")] = '\0';
        if (line[0] != '#')
            check_line(name, line, &t);
    }
    fclose(file);
    printf("%s: %d lines, %d of them zero; largest difference of f %.2f, of pdf %.2f of "
           "the tolerance\n", name,
           t.lines, t.zero, t.worst_f, t.worst_pdf);
    CHECK(t.lines > 100 && t.zero < t.lines / 2);
}

int main(int argc, char **argv) {
    for (int i = 1; i < argc; i++)
        check_file(argv[i]);
    return check_result();
}
