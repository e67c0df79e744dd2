// SPDX-License-Identifier: Apache-2.0
// Writes small files of measured materials, one or two of each format (and a MERL table, which is
// always large), for the tests: they are made while building, since nobody should have to store them.
//
// usage: make_material_files FOLDER
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "table/goniometer.h"
#include "table/merl.h"

static const char *folder;

static FILE *create(const char *name) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *f = fopen(path, "wb");
    if (!f) {
        perror(path);
        exit(1);
    }
    return f;
}

static const char *path_of(const char *name) {
    static char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

// A lobe over a base, about the mirror direction of (sin t, 0, cos t); stretched across it by `a`.
static double lobe(double t, double theta, double phi, double a) {
    const double x = sin(theta) * cos(phi) + sin(t), y = a * sin(theta) * sin(phi);
    return 0.1 + 2 * exp(-(x * x + y * y) * 20);
}

static void write_merl(void) {
    float(*rgb)[3] = mem_array(MERL_CELLS, sizeof *rgb);
    for (int i = 0; i < MERL_CELLS; i++) {
        const double h = pow(i / (MERL_THETA_D * MERL_PHI_D) / 90.0, 2) * M_PI / 2;
        const double d = i / MERL_PHI_D % MERL_THETA_D / 90.0, p = i % MERL_PHI_D / 180.0;
        for (int c = 0; c < 3; c++)
            rgb[i][c] = (float)(0.05 * (c + 1) + 3 * exp(-h * h * 60) * (0.2 + pow(d, 5)) +
                                0.01 * cos(2 * M_PI * p));
        if (i % 997 == 5)
            rgb[i][i % 3] = -1;
    }
    if (!merl_write(path_of("table.binary"), rgb))
        exit(1);
    mem_free(rgb);
    FILE *f = create("short.binary"); // a table that is cut off
    const int32_t head[] = {MERL_THETA_H, MERL_THETA_D, MERL_PHI_D, 0, 1, 2, 3};
    fwrite(head, 1, sizeof head, f);
    fclose(f);
}

static void write_transfer(const char *name, int phis, int symmetry, bool transmits) {
    struct goniometer_table t = {.theta_count = 4, .phi_count = phis, .symmetry = symmetry,
                                 .out_thetas = 10, .out_phis = 16};
    const size_t slice = goniometer_slice(&t);
    t.theta = mem_array(4, sizeof(float));
    t.phi = mem_array((size_t)phis, sizeof(float));
    for (int side = 0; side < 1 + transmits; side++)
        t.f[side] = mem_array(4 * (size_t)phis * slice, sizeof(float[3]));
    for (int i = 0; i < 4 * phis; i++) {
        const double theta = i % 4 * 22 * M_PI / 180;
        const double phi = phis > 1 ? 2 * M_PI / symmetry * (i / 4) / (phis - 1) : 0;
        t.theta[i % 4] = (float)theta;
        t.phi[i / 4] = (float)phi;
        for (size_t k = 0; k < slice; k++)
            for (int side = 0; side < 1 + transmits; side++)
                for (int c = 0; c < 3; c++)
                    t.f[side][(size_t)i * slice + k][c] = (float)(
                        (side ? 0.3 : 0.6 - 0.1 * c) *
                        lobe(theta, (double)(k / 16) * M_PI / 18,
                             (double)(k % 16) * M_PI / 8 - phi, 1 + 0.5 * cos(2 * phi)));
    }
    t.f[0][7][1] = -1;
    if (!transfer_write(path_of(name), &t))
        exit(1);
    mem_free(t.theta);
    mem_free(t.phi);
    mem_free(t.f[0]);
    mem_free(t.f[1]);
}

static void write_cornell(void) {
    FILE *f = create("paint.brdf");
    fprintf(f, "# a paint\n4\n# wavelengths\n400 500 600 700\n\n");
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 60; k++) {
            const double t = 0.2 + 0.4 * i, theta = k / 12 * 0.3, phi = k % 12 * M_PI / 6;
            const double v = lobe(t, theta, phi, 1);
            fprintf(f, "%f 0 %f %f %f %f %f %f\n", t, theta, phi, 0.2 * v, 0.3 * v, 0.5 * v,
                    0.4 * v);
        }
    fclose(f);
}

static void write_alta(void) {
    FILE *f = create("tape.dat");
    fprintf(f, "#SAMPLE \"tape\"\n#DIM 3 1\n#VS 0\n#PARAM_IN ISOTROPIC_TL_TV_PROJ_DPHI\n");
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 60; k++) {
            const double t = 0.25 + 0.4 * i, theta = k / 12 * 0.3, phi = k % 12 * M_PI / 6;
            fprintf(f, "%.9f  %.9f  %.9f  %.9f\n", t, theta * cos(phi), theta * sin(phi),
                    lobe(t, theta, phi + M_PI, 1));
        }
    fclose(f);
}

static void write_window(const char *name, bool matrix) {
    static const char *const sides[] = {"Reflection Front", "Reflection Back", "Transmission Front",
                                        "Transmission Back"};
    FILE *f = create(name);
    fprintf(f, "<?xml version=\"1.0\"?>\n<WindowElement><Optical><Layer><DataDefinition>\n"
               "<IncidentDataStructure>%s</IncidentDataStructure></DataDefinition>\n",
            matrix ? "Columns" : "TensorTree4");
    for (int s = 0; s < (matrix ? 4 : 3); s++) {
        fprintf(f, "<WavelengthData><Wavelength unit=\"Integral\">Visible</Wavelength>"
                   "<WavelengthDataBlock>\n<WavelengthDataDirection>%s</WavelengthDataDirection>",
                sides[s]);
        if (matrix)
            fprintf(f, "<ColumnAngleBasis>LBNL/Klems Quarter</ColumnAngleBasis>"
                       "<RowAngleBasis>LBNL/Klems Quarter</RowAngleBasis><ScatteringData>\n");
        else
            fprintf(f, "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis><ScatteringData>{\n");
        for (int i = 0; i < (matrix ? 41 * 41 : 16); i++)
            if (matrix)
                fprintf(f, "%.4f,%s", 0.02 + (i % 42 == 0 ? 0.8 : 0.001 * (i % 7)),
                        i % 41 == 40 ? "\n" : " ");
            else if (i % 5 == 0)
                for (int k = 0; k < 16; k++)
                    fprintf(f, "%s%.3f%s", k ? "" : "{ ", 0.02 * (k % 5) + 0.01 * s,
                            k == 15 ? " }\n" : " ");
            else
                fprintf(f, "{ %.3f }\n", 0.05 + 0.01 * (i % 3));
        fprintf(f, "%s</ScatteringData></WavelengthDataBlock></WavelengthData>\n",
                matrix ? "" : "}");
    }
    fprintf(f, "</Layer></Optical></WindowElement>\n");
    fclose(f);
}

// ---- tensor files ---------------------------------------------------------------------------

struct field {
    const char *name;
    int type, dimensions;
    uint64_t shape[5];
    const void *data;
};

static uint64_t field_count(const struct field *f) {
    uint64_t n = 1;
    for (int i = 0; i < f->dimensions; i++)
        n *= f->shape[i];
    return n;
}

static void write_tensor_file(const char *name, const struct field *fields, uint32_t count) {
    FILE *f = create(name);
    uint64_t offset = 18;
    for (uint32_t i = 0; i < count; i++)
        offset += 13 + strlen(fields[i].name) + 8 * (uint64_t)fields[i].dimensions;
    fwrite("tensor_file\0\1\0", 1, 14, f);
    fwrite(&count, 4, 1, f);
    for (uint32_t i = 0; i < count; i++) {
        const uint16_t length = (uint16_t)strlen(fields[i].name);
        const uint16_t dimensions = (uint16_t)fields[i].dimensions;
        fwrite(&length, 2, 1, f);
        fwrite(fields[i].name, 1, length, f);
        fwrite(&dimensions, 2, 1, f);
        fputc(fields[i].type, f);
        fwrite(&offset, 8, 1, f);
        fwrite(fields[i].shape, 8, dimensions, f);
        offset += field_count(&fields[i]) * (fields[i].type == 10 ? 4 : 1);
    }
    for (uint32_t i = 0; i < count; i++)
        fwrite(fields[i].data, fields[i].type == 10 ? 4 : 1, field_count(&fields[i]), f);
    fclose(f);
}

static float *wave(size_t count, double base, double step) {
    float *v = mem_array(count, sizeof *v);
    for (size_t i = 0; i < count; i++)
        v[i] = (float)(base * (1.2 + sin(step * (double)i)));
    return v;
}

static void write_rgl(const char *name, bool anisotropic) {
    enum { T = 4, N = 8, V = 16, MOST_PHI = 5, W = 5 };
    const float phi[MOST_PHI] = {(float)-M_PI, -2.4f, -1.6f, -0.8f, 0};
    const float one = 0, theta[T] = {0, 0.5f, 1, (float)(M_PI / 2)};
    const float wavelengths[W] = {400, 480, 560, 620, 700};
    const unsigned char description[] = "made for tests", jacobian = 1;
    const uint64_t p = anisotropic ? MOST_PHI : 1, channels = anisotropic ? W : 3;
    float *ndf = wave(2 * V, 1, 0.1), *sigma = wave(2 * V, 0.5, 0.05);
    float *vndf = wave(p * T * V * V, 1, 0.02);
    for (size_t i = 0; i < p * T * V * V; i++) // falls to 0 where half vectors crowd
        vndf[i] *= powf((float)(i % V) / (V - 1), 3) + 1e-6f * (float)(i % V);
    float *luminance = wave(p * T * N * N, 1, 0.07);
    float *colours = wave(p * T * channels * N * N, 0.3, 0.11);
    const struct field fields[] = {
        {"description", 1, 1, {sizeof description - 1}, description},
        {"phi_i", 10, 1, {p}, anisotropic ? phi : &one},
        {"theta_i", 10, 1, {T}, theta},
        {"sigma", 10, 2, {2, V}, sigma},
        {"ndf", 10, 2, {2, V}, ndf},
        {"vndf", 10, 4, {p, T, V, V}, vndf},
        {"luminance", 10, 4, {p, T, N, N}, luminance},
        {anisotropic ? "spectra" : "rgb", 10, 5, {p, T, channels, N, N}, colours},
        {"jacobian", 1, 1, {1}, &jacobian},
        {"wavelengths", 10, 1, {W}, wavelengths},
    };
    write_tensor_file(name, fields, anisotropic ? 10 : 9);
    mem_free(ndf);
    mem_free(sigma);
    mem_free(vndf);
    mem_free(luminance);
    mem_free(colours);
}

int main(int argc, char **argv) {
    if (argc != 2)
        return 2;
    folder = argv[1];
    write_merl();
    write_transfer("sheet.transfer", 1, 1, true);
    write_transfer("brushed.transfer", 3, 4, false);
    write_cornell();
    write_alta();
    write_window("matrix.xml", true);
    write_window("tree.xml", false);
    write_rgl("film.bsdf", false);
    write_rgl("brushed.bsdf", true);
    return 0;
}
