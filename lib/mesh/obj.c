// SPDX-License-Identifier: Apache-2.0
// Wavefront OBJ, read as Mitsuba 3 reads it: one mesh, whatever materials it names; polygons become
// fans about their first corner (exact for convex ones; a concave one is not what its author drew);
// v of texture coordinates is flipped by default; vertex normals are computed when the file has
// none. Beyond Mitsuba: negative indices, continued lines, colours of vertices ("v x y z r g b"
// becomes the attribute vertex_color, white where absent), single groups, corners without a normal
// (they get the computed one).
//
// Source: B1. Object Files (.obj), Wavefront Technologies, Advanced Visualizer 3.0.
#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"
#include "base/text.h"
#include "mesh/corner.h"
#include "mesh/reader.h"

struct list {
    float *data; // count times width values
    size_t count, capacity;
    int width;
};

struct obj {
    const struct mesh_options *options;
    struct where at; // the line that is read
    const char *p;   // in the text, which ends with a zero byte
    struct list v, vt, vn, colors; // colors is as long as v, or empty
    struct corner_table corners;
    uint32_t (*triangles)[3];
    size_t triangle_count, triangle_capacity;
    bool in_material; // by options->material_name; true without one
    bool in_object, in_group, ever_selected; // by options->shape_name; both true without one
    size_t points_and_lines, small_faces, free_forms;
    uint32_t furthest[3]; // largest index from zero of v, vt, vn in a face, plus one ...
    int furthest_line[3]; // ... and where it stands
};

// Bytes from p on that end the line: '\n', '\r', "\r\n". 0: none here.
static int line_end(const char *p) {
    if (*p == '\n')
        return 1;
    return *p != '\r' ? 0 : p[1] == '\n' ? 2 : 1;
}

// Skips blanks and line ends behind a backslash; true at the end of the line or of the text.
static bool skip_blanks(struct obj *o) {
    for (;;) {
        while (text_is_blank(*o->p))
            o->p++;
        const int continued = *o->p == '\\' ? line_end(o->p + 1) : 0;
        if (!continued)
            return !*o->p || line_end(o->p) > 0;
        o->p += 1 + continued;
        o->at.line++;
    }
}

static bool fail_expected(const struct obj *o, const char *expected) {
    char found[40];
    log_error_at(o->at, "found '%s', expected %s", text_excerpt(o->p, found, sizeof found),
                 expected);
    return false;
}

// Reads numbers up to the end of the line, at least `least` and at most `most` of them.
static bool read_numbers(struct obj *o, float *out, int least, int most, int *count) {
    for (*count = 0; !skip_blanks(o); ++*count) {
        const char *start = o->p;
        double x;
        if (*count == most)
            return fail_expected(o, "the end of the line");
        if (!text_number(&o->p, &x) || !(text_is_space(*o->p) || !*o->p || *o->p == '\\')) {
            o->p = start;
            return fail_expected(o, "a number");
        }
        out[*count] = (float)x;
        if (!isfinite(out[*count])) {
            o->p = start;
            return fail_expected(o, "a number of single precision (at most 3.4e38)");
        }
    }
    return *count >= least || fail_expected(o, "another number");
}

static void append(struct list *l, const float *values) {
    mem_grow(&l->data, &l->capacity, l->count + 1, (size_t)l->width * sizeof(float));
    memcpy(l->data + l->count++ * (size_t)l->width, values, (size_t)l->width * sizeof(float));
}

// "v x y z", "v x y z w" (the weight means nothing to polygons), "v x y z r g b" and
// "v x y z r g b a" (alpha is dropped)
static bool read_position(struct obj *o) {
    const float white[3] = {1, 1, 1};
    float x[7];
    int count;
    if (!read_numbers(o, x, 3, 7, &count))
        return false;
    if (count == 5)
        return fail_expected(o, "3 coordinates, or 3 coordinates and 3 components of a colour");
    append(&o->v, x);
    if (count >= 6)
        while (o->colors.count + 1 < o->v.count)
            append(&o->colors, white);
    if (count >= 6 || o->colors.count)
        append(&o->colors, count >= 6 ? x + 3 : white);
    return true;
}

static bool read_uv(struct obj *o) {
    float x[3] = {0};
    int count;
    if (!read_numbers(o, x, 1, 3, &count))
        return false;
    append(&o->vt, x);
    return true;
}

static bool read_normal(struct obj *o) {
    float x[3];
    int count;
    if (!read_numbers(o, x, 3, 3, &count))
        return false;
    append(&o->vn, x);
    return true;
}

// One index of a corner into the list `kind` (0: v, 1: vt, 2: vn); may point ahead in the file.
static bool read_index(struct obj *o, int kind, uint32_t *out) {
    static const char *const expected[] = {"the index of a vertex", "the index of a vt",
                                           "the index of a vn"};
    const size_t known = kind == 0 ? o->v.count : kind == 1 ? o->vt.count : o->vn.count;
    const char *start = o->p;
    int64_t i;
    if (!text_integer(&o->p, &i))
        return fail_expected(o, expected[kind]);
    if (i < 0)
        i += (int64_t)known + 1;
    if (i <= 0 || i >= CORNER_NONE) {
        o->p = start;
        return fail_expected(o, "an index that is in range");
    }
    *out = (uint32_t)(i - 1);
    if (i > o->furthest[kind]) {
        o->furthest[kind] = (uint32_t)i;
        o->furthest_line[kind] = o->at.line;
    }
    return true;
}

// "v", "v/vt", "v//vn" or "v/vt/vn"
static bool read_corner(struct obj *o, struct corner *c) {
    *c = (struct corner){CORNER_NONE, CORNER_NONE, CORNER_NONE};
    if (!read_index(o, 0, &c->v))
        return false;
    if (*o->p == '/') {
        o->p++;
        const bool ended = text_is_space(*o->p) || !*o->p; // "1/" is seen in the wild
        if (*o->p != '/' && !ended && !read_index(o, 1, &c->vt))
            return false;
        if (*o->p == '/') {
            o->p++;
            if (!text_is_space(*o->p) && *o->p && !read_index(o, 2, &c->vn))
                return false;
        }
    }
    if (!text_is_space(*o->p) && *o->p && *o->p != '\\')
        return fail_expected(o, "a blank after a corner");
    if (o->options->face_normals)
        c->vn = CORNER_NONE;
    return true;
}

static bool read_face(struct obj *o) {
    uint32_t fan[3];
    size_t corners = 0;
    for (; !skip_blanks(o); corners++) {
        struct corner c;
        if (!read_corner(o, &c))
            return false;
        if ((!o->in_object && !o->in_group) || !o->in_material)
            continue;
        fan[corners < 2 ? corners : 2] = corner_vertex(&o->corners, c);
        if (corners < 2)
            continue;
        mem_grow(&o->triangles, &o->triangle_capacity, o->triangle_count + 1,
                 sizeof *o->triangles);
        memcpy(o->triangles[o->triangle_count++], fan, sizeof fan);
        fan[1] = fan[2];
    }
    if (corners == 0)
        return fail_expected(o, "the corners of a face");
    o->small_faces += corners < 3;
    return true;
}

// The names behind "o" (one, with blanks) and "g" (several) decide what shape_name selects: an
// object with all its groups, or a group.
static bool read_group(struct obj *o, bool several) {
    const char *wanted = o->options->shape_name;
    if (!wanted)
        return true;
    const size_t n = strlen(wanted);
    bool found = false;
    while (!skip_blanks(o)) {
        const char *end = o->p + strcspn(o->p, several ? " \t\r\n" : "\r\n");
        const char *last = end;
        while (last > o->p && text_is_blank(last[-1]))
            last--;
        found |= (size_t)(last - o->p) == n && memcmp(o->p, wanted, n) == 0;
        o->p = end;
    }
    o->in_object = several ? o->in_object : found;
    o->in_group = several && found;
    o->ever_selected |= found;
    return true;
}

// The name behind "usemtl", which may hold blanks.
static bool read_material(struct obj *o) {
    const char *wanted = o->options->material_name;
    skip_blanks(o);
    const char *end = o->p + strcspn(o->p, "\r\n");
    while (end > o->p && text_is_blank(end[-1]))
        end--;
    const size_t n = (size_t)(end - o->p);
    o->in_material = !wanted || (strlen(wanted) == n && memcmp(o->p, wanted, n) == 0);
    return true;
}

static bool word_is(const char *word, size_t n, const char *name) {
    return strncmp(word, name, n) == 0 && name[n] == '\0';
}

// Statements that a polygon mesh can do without. Free forms and points are counted, to be told.
static bool skip_statement(struct obj *o, const char *word, size_t n) {
    static const char *const ignored[] = {
        "mtllib", "s", "vp", "mg", "bevel", "c_interp", "d_interp", "lod", "maplib",
        "usemap", "shadow_obj", "trace_obj", "deg", "bmat", "step", "cstype", "parm", "trim",
        "hole", "scrv", "sp", "end", "con", "call", "csh", NULL};
    static const char *const free_forms[] = {"curv", "curv2", "surf", NULL};
    for (const char *const *k = free_forms; *k; k++)
        if (word_is(word, n, *k))
            return o->free_forms++, true;
    if (word_is(word, n, "p") || word_is(word, n, "l"))
        return o->points_and_lines++, true;
    for (const char *const *k = ignored; *k; k++)
        if (word_is(word, n, *k))
            return true;
    o->p = word;
    return fail_expected(o, "a statement of the OBJ format (v, vt, vn, f, g, o, usemtl, ...)");
}

// One line from its first character to its end.
static bool read_line(struct obj *o) {
    if (skip_blanks(o) || *o->p == '#')
        return true;
    const char *word = o->p;
    size_t n = 0;
    while (word[n] && !text_is_space(word[n]) && word[n] != '\\')
        n++;
    o->p += n;
    if (word_is(word, n, "v"))
        return read_position(o);
    if (word_is(word, n, "f") || word_is(word, n, "fo"))
        return read_face(o);
    if (word_is(word, n, "vn"))
        return read_normal(o);
    if (word_is(word, n, "vt"))
        return read_uv(o);
    if (word_is(word, n, "o") || word_is(word, n, "g"))
        return read_group(o, *word == 'g');
    if (word_is(word, n, "usemtl"))
        return read_material(o);
    return skip_statement(o, word, n);
}

// A file has at most 4 GiB and a corner at least two bytes, so 32 bits suffice for all counts.
static bool read_text(struct obj *o, const char *text, size_t size) {
    const unsigned char *b = (const unsigned char *)text;
    if (size >= 2 && ((b[0] == 0xff && b[1] == 0xfe) || (b[0] == 0xfe && b[1] == 0xff))) {
        log_error("%s: is UTF-16 text, expected UTF-8 or ASCII", o->at.file);
        return false;
    }
    const bool mark = size >= 3 && b[0] == 0xef && b[1] == 0xbb && b[2] == 0xbf;
    o->p = text + (mark ? 3 : 0);
    for (o->at.line = 1; o->p < text + size; o->at.line++) {
        if (!read_line(o))
            return false;
        o->p += strcspn(o->p, "\r\n"); // what is left of comments and skipped statements
        o->p += line_end(o->p);
        if (!*o->p && o->p < text + size)
            return fail_expected(o, "text, not a zero byte");
        if (o->at.line == INT_MAX)
            return fail_expected(o, "fewer lines");
    }
    return true;
}

// Indices that point ahead can be checked only now.
static bool check_indices(struct obj *o) {
    static const char *const names[] = {"vertices", "texture coordinates", "normals"};
    const size_t counts[] = {o->v.count, o->vt.count, o->vn.count};
    for (int k = 0; k < 3; k++)
        if (o->furthest[k] > counts[k]) {
            o->at.line = o->furthest_line[k];
            log_error_at(o->at, "found the index %u, but the file has %zu %s", o->furthest[k],
                         counts[k], names[k]);
            return false;
        }
    return true;
}

static void gather(const struct list *from, const struct obj *o, size_t field, float *to) {
    const size_t bytes = (size_t)from->width * sizeof(float);
    for (size_t i = 0; i < o->corners.count; i++, to += from->width) {
        uint32_t index;
        memcpy(&index, (const char *)&o->corners.corners[i] + field, sizeof index);
        if (index != CORNER_NONE)
            memcpy(to, from->data + index * (size_t)from->width, bytes);
    }
}

static void fill_mesh(struct obj *o, struct mesh *m) {
    const size_t count = o->corners.count;
    m->vertex_count = (uint32_t)count;
    m->triangle_count = (uint32_t)o->triangle_count;
    m->indices = mem_array(o->triangle_count, sizeof *m->indices);
    memcpy(m->indices, o->triangles, o->triangle_count * sizeof *m->indices);
    mem_free(o->triangles);
    o->triangles = NULL;
    m->positions = mesh_alloc_positions(count);
    gather(&o->v, o, offsetof(struct corner, v), m->positions[0]);
    if (o->furthest[1]) {
        m->uvs = mem_array(count, sizeof *m->uvs);
        gather(&o->vt, o, offsetof(struct corner, vt), m->uvs[0]);
    }
    if (o->furthest[2] && !o->options->face_normals) {
        m->normals = mem_array(count, sizeof *m->normals);
        gather(&o->vn, o, offsetof(struct corner, vn), m->normals[0]);
    }
    if (o->colors.count)
        gather(&o->colors, o, offsetof(struct corner, v),
               mesh_add_attribute(m, o->at.file, "vertex_color", 3, count)->data);
}

static bool report(const struct obj *o) {
    const char *path = o->at.file, *name = o->options->shape_name;
    if (name && !o->ever_selected) {
        log_error("%s: holds no object or group '%s'", path, name);
        return false;
    }
    if (o->triangle_count == 0) {
        log_error("%s: holds no faces%s, expected at least one (%zu vertices, %zu points and "
                  "lines)", path, name ? " in that group" : "", o->v.count, o->points_and_lines);
        return false;
    }
    if (o->points_and_lines)
        log_warn("%s: %zu points and lines are skipped", path, o->points_and_lines);
    if (o->small_faces)
        log_warn("%s: %zu faces with fewer than 3 corners are skipped", path, o->small_faces);
    if (o->free_forms)
        log_warn("%s: %zu free-form curves and surfaces are skipped", path, o->free_forms);
    return true;
}

static void finish(struct obj *o) {
    mem_free(o->v.data);
    mem_free(o->vt.data);
    mem_free(o->vn.data);
    mem_free(o->colors.data);
    mem_free(o->triangles);
    corner_table_finish(&o->corners);
}

static bool read_obj(const char *path, const struct mesh_options *options, struct mesh *m) {
    *m = (struct mesh){0};
    size_t size;
    char *text = file_read(path, 0, &size);
    if (!text)
        return false;
    struct obj o = {.options = options, .at = {path, 0}, .in_object = !options->shape_name,
                    .in_material = !options->material_name || !*options->material_name,
                    .v.width = 3, .vt.width = 2, .vn.width = 3, .colors.width = 3};
    bool good = read_text(&o, text, size);
    mem_free(text);
    good = good && check_indices(&o) && report(&o);
    if (good)
        fill_mesh(&o, m);
    finish(&o);
    good = good && mesh_complete(m, path, options, !options->flip_uvs);
    if (!good)
        mesh_finish(m);
    return good;
}

static const char *const extensions[] = {"obj", NULL};

const struct mesh_reader_type mesh_reader_obj = {
    .entry = {.name = "obj", .help = "Wavefront OBJ, polygons of one file or of one group"},
    .extensions = extensions,
    .read = read_obj,
};
