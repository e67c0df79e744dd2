// SPDX-License-Identifier: Apache-2.0
// Photometric files: values at measured angles, between them and mirrored, for types C, B and A; the
// factors of each edition; what is refused.
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "capture.h"
#include "check.h"
#include "base/file.h"
#include "light/ies_profile.h"

static const char *folder;

static bool read_file(const char *name, float tilt, struct ies_profile *p) {
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return ies_profile_read(path, tilt, p);
}

// Towards vertical and horizontal angle of the file's type, in degrees (as the header defines them).
static vec3 towards(enum ies_type type, double v, double h) {
    v *= M_PI / 180;
    h *= M_PI / 180;
    if (type == IES_TYPE_C)
        return v3((float)(sin(v) * cos(h)), (float)(-sin(v) * sin(h)), (float)cos(v));
    if (type == IES_TYPE_B)
        return v3((float)(cos(h) * sin(v)), (float)sin(h), (float)(cos(h) * cos(v)));
    return v3((float)(cos(v) * cos(h)), (float)(cos(v) * sin(h)), (float)-sin(v));
}

static void check_value(const struct ies_profile *p, double v, double h, double expected) {
    CHECK_NEAR(ies_profile_eval(p, towards(p->type, v, h)), expected, 1e-3 * (1 + expected));
}

static void check_type_c(void) {
    struct ies_profile p;
    CHECK(read_file("type_c.ies", 0, &p) && p.type == IES_TYPE_C);
    check_value(&p, 0, 0, 400);
    check_value(&p, 30, 0, 300);
    check_value(&p, 60, 90, 200);
    check_value(&p, 45, 0, 230);
    check_value(&p, 30, 22.5, 310);
    check_value(&p, 60, 135, 180); // the quadrant stands for all four
    check_value(&p, 60, 270, 200);
    check_value(&p, 60, 315, 180);
    check_value(&p, 95, 0, 0);
    CHECK_NEAR(ies_profile_cone(&p), cos(90.01 * M_PI / 180), 1e-5);
    ies_profile_finish(&p);
    CHECK(read_file("type_c_bilateral.ies", 0, &p));
    check_value(&p, 120, 180, 72);
    check_value(&p, 60, 270, 90);
    check_value(&p, 60, 225, 99);
    check_value(&p, 180, 77, 9);
    CHECK(ies_profile_cone(&p) == -1);
    ies_profile_finish(&p);
    CHECK(read_file("type_c_bilateral.ies", 67.5f, &p));
    check_value(&p, 60, 270, 90 * 0.8);
    ies_profile_finish(&p);
}

static void check_types_b_and_a(void) {
    struct ies_profile p;
    CHECK(read_file("type_b.ies", 0, &p) && p.type == IES_TYPE_B);
    check_value(&p, 0, 0, 360); // 90 x 10 x 0.8 x 0.5: the second factor counts in 1991
    check_value(&p, 30, -20, 200);
    check_value(&p, -60, 20, 32);
    check_value(&p, 0, 60, 0);
    ies_profile_finish(&p);
    CHECK(read_file("type_a.ies", 0, &p) && p.type == IES_TYPE_A);
    check_value(&p, 0, 0, 1000);
    check_value(&p, 10, 10, 20);
    check_value(&p, -10, -20, 5);
    check_value(&p, 5, -10, 120);
    check_value(&p, 0, 90, 0);
    ies_profile_finish(&p);
}

// A lamp of 100 cd all around: 400 pi lumen.
static void check_flux(void) {
    char path[64];
    snprintf(path, sizeof path, "/tmp/relume-%d.ies", (int)getpid());
    const char *text = "IESNA:LM-63-2002\nTILT=NONE\n1 1 1 2 1 1 2 0 0 0\n1 1 1\n0 180\n0\n100 100\n";
    struct ies_profile p;
    CHECK(file_write(path, text, strlen(text)) && ies_profile_read(path, 0, &p));
    CHECK_NEAR(ies_profile_flux(&p) / (400 * M_PI), 1, 1e-4);
    ies_profile_finish(&p);
    unlink(path);
}

static void check_refused(void) {
    static const char *const texts[][2] = {
        {"", "TILT="},
        {"IESNA:LM-63-2002\nTILT=NONE\n", "number of lamps"},
        {"TILT=NONE\n1 1 1 2 1 4 2 0 0 0\n1 1 1\n0 90\n0\n1 1\n", "photometric type"},
        {"TILT=NONE\n1 1 1 2 1 1 2 0 0 0\n1 1 1\n90 0\n0\n1 1\n", "vertical angle"},
        {"TILT=NONE\n1 1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n1 nan\n", "candela"},
        {"TILT=NONE\n1 1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n1\n", "candela"},
        {"TILT=NONE\n1 1 1 99999 99999 1 2 0 0 0\n1 1 1\n0 90\n", "at most"},
        {"TILT=NONE\n1 1 -3 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n1 1\n", "multiplier"},
        {"TILT=NONE\n1 1 1 2 1 2 2 0 0 0\n1 1 1\n0 120\n0\n1 1\n", "-90 to 90"},
        {"TILT=INCLUDE\n7\n", "geometry"},
    };
    char path[64];
    snprintf(path, sizeof path, "/tmp/relume-%d.ies", (int)getpid());
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        struct ies_profile p;
        CHECK(file_write(path, texts[i][0], strlen(texts[i][0])));
        capture_begin();
        CHECK(!ies_profile_read(path, 0, &p) && !p.candela && !p.vertical);
        const char *said = capture_end();
        CHECK(strstr(said, path) && strstr(said, texts[i][1]));
    }
    unlink(path);
}

// A street lamp of 13 000 lm whose luminaire loses some.
static void check_real(void) {
    const char *shared = getenv("RELUME_SHARED_DATA");
    char path[1024];
    struct ies_profile p;
    if (!shared)
        return;
    snprintf(path, sizeof path, "%s/scenes/ies/ASA_15M_R2.ies", shared);
    CHECK(ies_profile_read(path, 0, &p));
    const double flux = (double)ies_profile_flux(&p);
    printf("street lamp: %.0f of 13000 lm leave it\n", flux);
    CHECK(flux > 0.5 * 13000 && flux < 13000);
    check_value(&p, 0, 0, 1666);
    ies_profile_finish(&p);
}

int main(int argc, char **argv) {
    folder = argc > 1 ? argv[1] : "data/lights";
    check_type_c();
    check_types_b_and_a();
    check_flux();
    check_refused();
    check_real();
    return check_result();
}
