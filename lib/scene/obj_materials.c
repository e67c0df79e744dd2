// SPDX-License-Identifier: Apache-2.0
// Wavefront MTL (Alias|Wavefront, MTL Material Format 4.2, 1995; Pr, Pm, Ke and norm after the PBR
// extension of Exocortex Clara.io).
#include "scene/obj_materials.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "math/ior.h"
#include "scene/format_tables.h"

enum field_kind { NUMBER, COLOUR, FILENAME, ELSEWHERE }; // ELSEWHERE: not read as a field

static const struct field {
    const char *word;
    enum field_kind kind;
    size_t offset;
    size_t given; // of a bool that is set, or 0
    const char *here; // what becomes of it
} fields[] = {
    {"Kd", COLOUR, offsetof(struct mtl, Kd), 0, "principled: base_color"},
    {"Ks", COLOUR, offsetof(struct mtl, Ks), offsetof(struct mtl, has_Ks),
     "principled: specular (its luminance); black: none"},
    {"Ke", COLOUR, offsetof(struct mtl, Ke), 0, "area light on the side of the normals"},
    {"Tf", COLOUR, offsetof(struct mtl, Tf), 0, "dielectric: specular_transmittance"},
    {"Ns", NUMBER, offsetof(struct mtl, Ns), 0,
     "principled: roughness = sqrt(alpha), alpha^2 = 2 / (Ns + 2)"},
    {"Ni", NUMBER, offsetof(struct mtl, Ni), 0, "dielectric: int_ior, where illum is 4, 6, 7 or 9"},
    {"d", NUMBER, offsetof(struct mtl, d), 0, "mask: opacity"},
    {"Pr", NUMBER, offsetof(struct mtl, Pr), offsetof(struct mtl, has_Pr), "principled: roughness"},
    {"Pm", NUMBER, offsetof(struct mtl, Pm), offsetof(struct mtl, has_Pm), "principled: metallic"},
    {"map_Kd", FILENAME, offsetof(struct mtl, map_Kd), 0, "principled: base_color"},
    {"map_d", FILENAME, offsetof(struct mtl, map_d), 0, "mask: opacity"},
    {"map_Ke", FILENAME, offsetof(struct mtl, map_Ke), 0, "area light on the side of the normals"},
    {"map_Pr", FILENAME, offsetof(struct mtl, map_Pr), 0, "principled: roughness"},
    {"map_Pm", FILENAME, offsetof(struct mtl, map_Pm), 0, "principled: metallic"},
    {"norm", FILENAME, offsetof(struct mtl, norm), 0, "normalmap"},
    {"map_Bump", FILENAME, offsetof(struct mtl, bump), 0, "bumpmap"},
    {"map_bump", FILENAME, offsetof(struct mtl, bump), 0, "bumpmap"},
    {"bump", FILENAME, offsetof(struct mtl, bump), 0, "bumpmap"},
    {"illum", ELSEWHERE, 0, 0, "4, 6, 7, 9: dielectric"},
    {"Tr", ELSEWHERE, 0, 0, "mask: opacity = 1 - Tr"},
    {"Ka", ELSEWHERE, 0, 0, "nothing"},
    {"map_Ka", ELSEWHERE, 0, 0, "nothing"},
    {"map_Ks", ELSEWHERE, 0, 0, "nothing"},
    {"map_Ns", ELSEWHERE, 0, 0, "nothing"},
};

static const struct mtl plain = {.Kd = {0.8, 0.8, 0.8}, .Tf = {1, 1, 1}, .Ni = 1.5, .d = 1};

static bool read_number(const char **p, double *out) {
    while (text_is_blank(**p))
        ++*p;
    return text_number(p, out) && isfinite(*out);
}

static bool read_colour(const char *p, double out[3]) {
    if (!read_number(&p, &out[0]))
        return false;
    out[1] = out[2] = out[0];
    return !read_number(&p, &out[1]) || read_number(&p, &out[2]);
}

// The last word of a statement: options come before it.
static const char *read_filename(struct reader *r, const char *p) {
    while (text_is_blank(*p))
        p++;
    const char *name = p;
    while (*name == '-') { // an option and its arguments, which are numbers or on and off
        name += strcspn(name, " \t");
        for (bool more = true; more;) {
            double unused;
            const char *next = name;
            while (text_is_blank(*next))
                next++;
            const size_t word = strcspn(next, " \t");
            more = text_number(&next, &unused) || (word == 2 && strncmp(next, "on", 2) == 0) ||
                   (word == 3 && strncmp(next, "off", 3) == 0);
            name = more ? next + strcspn(next, " \t") : name;
        }
        while (text_is_blank(*name))
            name++;
    }
    return *name ? arena_strdup(r->arena, name) : NULL;
}

static bool read_field(struct reader *r, const struct field *f, struct mtl *m, const char *p,
                       struct where at) {
    void *out = (char *)m + f->offset;
    bool ok = true;
    if (f->kind == COLOUR)
        ok = read_colour(p, out);
    else if (f->kind == NUMBER)
        ok = read_number(&p, out);
    else if (f->kind == FILENAME)
        *(const char **)out = read_filename(r, p);
    if (f->given)
        *((bool *)m + f->given) = true;
    if (!ok)
        log_warn_at(at, "%s holds no numbers and is skipped", f->word);
    return true;
}

static void read_statement(struct reader *r, struct list *materials, char *line,
                           struct where at) {
    char *p = line + strspn(line, " \t");
    const size_t n = strcspn(p, " \t");
    char *rest = p + n + strspn(p + n, " \t");
    for (size_t end = strlen(rest); end > 0 && text_is_space(rest[end - 1]);)
        rest[--end] = '\0';
    if (n == 6 && strncmp(p, "newmtl", 6) == 0) {
        *LIST_ADD(materials, struct mtl) = plain;
        LIST_AT(materials, struct mtl, materials->count - 1).name = arena_strdup(r->arena, rest);
        return;
    }
    if (materials->count == 0 || n == 0 || *p == '#')
        return;
    struct mtl *m = &LIST_AT(materials, struct mtl, materials->count - 1);
    double v;
    const char *number = rest;
    if (n == 5 && strncmp(p, "illum", 5) == 0 && read_number(&number, &v))
        m->glass = v == 4 || v == 6 || v == 7 || v == 9;
    if (n == 2 && strncmp(p, "Tr", 2) == 0 && read_number(&number, &v))
        m->d = 1 - v;
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        if (strlen(fields[i].word) == n && strncmp(p, fields[i].word, n) == 0)
            read_field(r, &fields[i], m, rest, at);
}

bool mtl_read(struct reader *r, const char *path, struct list *materials) {
    size_t size;
    char *text = file_read(path, 0, &size);
    struct where at = {arena_strdup(r->arena, path), 0};
    if (!text || !load_hash_file(r, at.file)) {
        mem_free(text);
        return false;
    }
    for (char *p = text; p < text + size;) {
        char *end = p + strcspn(p, "\r\n");
        at.line += *end != '\r' || end[1] != '\n';
        const bool last = end >= text + size;
        *end = '\0';
        read_statement(r, materials, p, at);
        p = last ? text + size : end + 1;
    }
    mem_free(text);
    return true;
}

void mtl_print_table(void) {
    const size_t count = sizeof fields / sizeof *fields;
    printf("| MTL | here |\n|---|---|\n");
    for (size_t i = 0; i < count; i++) { // what becomes the same stands in one row
        bool printed = false;
        for (size_t k = 0; k < i; k++)
            printed |= strcmp(fields[k].here, fields[i].here) == 0;
        for (size_t k = i; k < count && !printed; k++)
            if (strcmp(fields[k].here, fields[i].here) == 0)
                printf("%s`%s`", k == i ? "| " : " ", fields[k].word);
        if (!printed)
            printf(" | %s |\n", fields[i].here);
    }
}

// ---- elements -------------------------------------------------------------------------------

static double share(double v) {
    return fmin(fmax(v, 0), 1);
}

// A file that is not there leaves the constant: materials travel without their pictures.
static bool add_map(struct reader *r, struct xml_node *parent, const char *name, const char *file,
                    bool raw) {
    char directory[PATH_MAX];
    if (!file)
        return false;
    file_directory(r->scene->path, directory, sizeof directory);
    char *turned = arena_strdup(r->arena, file);
    for (char *c = turned; *c; c++)
        *c = *c == '\\' ? '/' : *c;
    const char *path =
        *turned == '/' ? turned : arena_printf(r->arena, "%s/%s", directory, turned);
    if (!file_exists(path)) {
        log_warn("%s: there is no picture \"%s\": its constant takes its place", r->scene->path,
                 file);
        return false;
    }
    struct xml_node *node = tree_add(r, parent, "texture", "bitmap", NULL);
    xml_set(node, "name", name, r->arena);
    tree_text(r, node, "string", "filename", turned);
    if (raw)
        tree_text(r, node, "boolean", "raw", "true");
    // row 0 of a picture is at v = 1 in MTL and at v = 0 here, and the mesh reader has turned v
    return true;
}

static void add_glass(struct reader *r, struct xml_node *parent, const struct mtl *m) {
    struct xml_node *node = tree_add(r, parent, "bsdf", "dielectric", NULL);
    const double Tf[3] = {share(m->Tf[0]), share(m->Tf[1]), share(m->Tf[2])};
    tree_number(r, node, "int_ior", fmin(fmax(m->Ni, 1), (double)IOR_MOST));
    tree_triple(r, node, "rgb", "specular_transmittance", Tf);
}

static void add_principled(struct reader *r, struct xml_node *parent, const struct mtl *m) {
    struct xml_node *node = tree_add(r, parent, "bsdf", "principled", NULL);
    const double Kd[3] = {share(m->Kd[0]), share(m->Kd[1]), share(m->Kd[2])};
    const double Ks = share(0.2126 * m->Ks[0] + 0.7152 * m->Ks[1] + 0.0722 * m->Ks[2]);
    const double rough = m->has_Pr ? share(m->Pr) : pow(2 / (fmax(m->Ns, 0) + 2), 0.25);
    if (!add_map(r, node, "base_color", m->map_Kd, false))
        tree_triple(r, node, "rgb", "base_color", Kd);
    if (!add_map(r, node, "roughness", m->map_Pr, true))
        tree_number(r, node, "roughness", rough);
    if (!add_map(r, node, "metallic", m->map_Pm, true))
        tree_number(r, node, "metallic", m->has_Pm ? share(m->Pm) : 0);
    if (!m->has_Pr)
        tree_number(r, node, "specular", m->has_Ks ? Ks : 0);
}

const char *mtl_add_bsdf(struct reader *r, struct xml_node *scene, const struct mtl *m) {
    struct xml_node holder = {0}, *node = &holder;
    if (m->map_d || m->d < 1) {
        node = tree_add(r, node, "bsdf", "mask", NULL);
        if (!add_map(r, node, "opacity", m->map_d, true))
            tree_number(r, node, "opacity", share(m->d));
    }
    if (!m->glass)
        node = tree_add(r, node, "bsdf", "twosided", NULL);
    if (m->norm || m->bump) {
        struct xml_node *bumps =
            tree_add(r, NULL, "bsdf", m->norm ? "normalmap" : "bumpmap", NULL);
        if (add_map(r, bumps, m->norm ? "normalmap" : "texture", m->norm ? m->norm : m->bump,
                    true)) {
            xml_append(node, bumps);
            node = bumps;
        }
    }
    if (m->glass)
        add_glass(r, node, m);
    else
        add_principled(r, node, m);
    const char *id = tree_free_id(r, m->name, "material");
    xml_set(holder.first, "id", id, r->arena);
    xml_append(scene, holder.first);
    return id_define(r, id, holder.first, holder.first->at) ? id : NULL;
}

bool mtl_emits(const struct mtl *m) {
    return m->Ke[0] > 0 || m->Ke[1] > 0 || m->Ke[2] > 0;
}

void mtl_add_emitter(struct reader *r, struct xml_node *shape, const struct mtl *m) {
    struct xml_node *light = tree_add(r, shape, "emitter", "area", NULL);
    const double Ke[3] = {fmax(m->Ke[0], 0), fmax(m->Ke[1], 0), fmax(m->Ke[2], 0)};
    if (!add_map(r, light, "radiance", m->map_Ke, false))
        tree_triple(r, light, "rgb", "radiance", Ke);
}
