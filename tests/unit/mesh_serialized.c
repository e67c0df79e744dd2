// SPDX-License-Identifier: Apache-2.0
#include <math.h>
#include <stdint.h>
#include <zlib.h>

#include "base/mem.h"
#include "check.h"
#include "mesh_read.h"

struct bytes {
    unsigned char data[65536];
    size_t size;
};

static void put(struct bytes *b, const void *p, size_t n) {
    memcpy(b->data + b->size, p, n);
    b->size += n;
}

static void put_integer(struct bytes *b, uint64_t x, int n) {
    for (int i = 0; i < n; i++, x >>= 8)
        b->data[b->size++] = (unsigned char)x;
}

static void put_numbers(struct bytes *b, const double *x, int n, bool doubles) {
    for (int i = 0; i < n; i++) {
        const float f = (float)x[i];
        if (doubles)
            put(b, &x[i], sizeof x[i]);
        else
            put(b, &f, sizeof f);
    }
}

// What a test may bend: a triangle with z = scale.
struct plan {
    int version;
    uint32_t flags;
    double scale;
    uint64_t vertices, triangles;
    uint32_t index;
};

static const struct plan good = {4, 0x1000, 1, 3, 1, 2};

static void put_mesh(struct bytes *file, const struct plan *p) {
    const bool doubles = p->flags & 0x2000;
    const double positions[] = {0, 0, p->scale, 1, 0, p->scale, 0, 1, p->scale};
    const double normals[] = {0, 0, -2, 0, 0, -2, 0, 0, -2}, uvs[] = {0, .25, 1, .25, 1, 1};
    const double colors[] = {.1, .2, .3, .4, .5, .6, .7, .8, .9};
    static struct bytes raw;
    raw.size = 0;
    put_integer(&raw, p->flags, 4);
    if (p->version == 4)
        put(&raw, "name", 5);
    put_integer(&raw, p->vertices, 8);
    put_integer(&raw, p->triangles, 8);
    put_numbers(&raw, positions, 9, doubles);
    if (p->flags & 1)
        put_numbers(&raw, normals, 9, doubles);
    if (p->flags & 2)
        put_numbers(&raw, uvs, 6, doubles);
    if (p->flags & 8)
        put_numbers(&raw, colors, 9, doubles);
    put_integer(&raw, 0, 4);
    put_integer(&raw, 1, 4);
    put_integer(&raw, p->index, 4);
    put_integer(file, 0x041c, 2);
    put_integer(file, (uint64_t)p->version, 2);
    uLongf n = sizeof file->data - file->size;
    compress(file->data + file->size, &n, raw.data, raw.size);
    file->size += n;
}

// A file of two meshes, the second at z = 7.
static void make_file(struct bytes *file, const struct plan *p) {
    file->size = 0;
    put_mesh(file, p);
    const size_t second = file->size;
    struct plan other = *p;
    other.scale = 7;
    put_mesh(file, &other);
    put_integer(file, 0, p->version == 4 ? 8 : 4);
    put_integer(file, second, p->version == 4 ? 8 : 4);
    put_integer(file, 2, 4);
}

static bool read_file(const struct bytes *file, int index, struct mesh *m) {
    const struct mesh_options options = {.shape_index = index};
    return read_mesh_data("serialized", file->data, file->size, &options, m);
}

static bool refuses_plan(const struct plan *p, const char *expected) {
    static struct bytes file;
    struct mesh m;
    make_file(&file, p);
    if (!read_file(&file, 0, &m) && !m.positions && captured_has(expected) &&
        captured_has("mesh-test-"))
        return true;
    printf("expected '%s': %s\n", expected, captured);
    return false;
}

static void serialized_reads_versions_3_and_4(void) {
    static struct bytes file;
    for (int version = 3; version <= 4; version++)
        for (int index = 0; index < 2; index++) {
            struct plan p = good;
            struct mesh m;
            p.version = version;
            make_file(&file, &p);
            CHECK(read_file(&file, index, &m));
            CHECK(m.vertex_count == 3 && has_triangle(&m, 0, 0, 1, 2));
            CHECK(m.positions && m.positions[2][2] == (index ? 7 : 1));
            CHECK(m.normals_computed && m.normals[0][2] == 1 && !m.uvs);
            mesh_finish(&m);
        }
}

static void serialized_reads_all_arrays_in_both_precisions(void) {
    static struct bytes file;
    for (int k = 1; k <= 2; k++) {
        struct plan p = good;
        struct mesh m;
        p.flags = 0x1000u * (unsigned)k | 0xb;
        make_file(&file, &p);
        CHECK(read_file(&file, 0, &m));
        const struct mesh_attribute *a = mesh_find_attribute(&m, "vertex_color");
        CHECK(m.normals && m.normals[1][2] == -1 && !m.normals_computed);
        CHECK(m.uvs && m.uvs[0][1] == .25f && m.uvs[2][1] == 1);
        CHECK(a && a->channels == 3 && a->data[8] == .9f);
        mesh_finish(&m);
    }
}

static void serialized_flag_of_face_normals_drops_normals(void) {
    static struct bytes file;
    struct plan p = good;
    struct mesh m;
    p.flags |= 0x11;
    make_file(&file, &p);
    CHECK(read_file(&file, 0, &m) && !m.normals);
    mesh_finish(&m);
}

// A file is looked at where the mesh lies alone: that with a gigabyte of nothing between the meshes and
// their table takes no gigabyte of memory.
static void serialized_reads_one_mesh_of_many(void) {
    static struct bytes file;
    const char path[] = "mesh-test-hole.serialized";
    const long hole = 1L << 30, table = 2 * 8 + 4;
    make_file(&file, &good);
    FILE *f = fopen(path, "wb");
    CHECK(f && fwrite(file.data, 1, file.size - (size_t)table, f) == file.size - (size_t)table &&
          fseek(f, hole, SEEK_SET) == 0 &&
          fwrite(file.data + file.size - table, 1, (size_t)table, f) == (size_t)table && fclose(f) == 0);
    const size_t before = mem_peak();
    int meshes = 0;
    CHECK(mesh_reader_serialized.count(path, &meshes) && meshes == 2);
    for (int i = 0; i < 2; i++) {
        struct mesh m;
        CHECK(mesh_reader_serialized.read(path, &(struct mesh_options){.shape_index = i}, &m));
        CHECK(m.positions && m.positions[2][2] == (i ? 7 : 1));
        mesh_finish(&m);
    }
    CHECK(mem_peak() - before < 100 << 20);
    remove(path);
}

static void serialized_refuses_bad_values(void) {
    struct plan p = good;
    p.scale = NAN;
    CHECK(refuses_plan(&p, "number 2 of the positions"));
    p.flags = 0x2000;
    p.scale = 1e39;
    CHECK(refuses_plan(&p, "number 2 of the positions"));
    p = good;
    p.index = 3;
    CHECK(refuses_plan(&p, "found the index 3 in triangle 0"));
    p = good;
    p.flags |= 0x40;
    CHECK(refuses_plan(&p, "found the flags 0x1040"));
    p = good;
    p.triangles = 0;
    CHECK(refuses_plan(&p, "holds no faces"));
}

static void serialized_refuses_counts_the_file_cannot_hold(void) {
    struct plan p = good;
    p.vertices = UINT64_MAX;
    CHECK(refuses_plan(&p, "announces 18446744073709551615 vertices"));
    p.vertices = 80000000;
    CHECK(refuses_plan(&p, "announces 80000000 vertices"));
    p.vertices = 5000; // more than there is, less than the best compression would allow
    CHECK(refuses_plan(&p, "damaged or truncated"));
    p = good;
    p.triangles = 1ull << 60;
    CHECK(refuses_plan(&p, "announces"));
}

static void serialized_refuses_bad_tables(void) {
    static struct bytes file;
    struct mesh m;
    make_file(&file, &good);
    CHECK(!read_file(&file, 2, &m) && captured_has("has no mesh number 2"));
    CHECK(!read_file(&file, -1, &m) && captured_has("has no mesh number -1"));
    file.data[file.size - 12] = 1; // offset of the second mesh
    CHECK(!read_file(&file, 1, &m) && captured_has("has no header of a serialized mesh"));
    memset(file.data + file.size - 12, 0xff, 8);
    CHECK(!read_file(&file, 1, &m) && captured_has("begins at byte 18446744073709551615"));
    memset(file.data + file.size - 4, 0xff, 4);
    CHECK(!read_file(&file, 1, &m) && captured_has("announces 4294967295"));
}

static void serialized_refuses_every_truncation(void) {
    static struct bytes file;
    struct mesh m;
    file.size = 0;
    put_mesh(&file, &good);
    const size_t whole = file.size;
    CHECK(read_file(&file, 0, &m)); // the table is not needed for the first
    mesh_finish(&m);
    for (file.size = 0; file.size + 5 < whole; file.size++) // the checksum is behind all data
        CHECK(!read_file(&file, 0, &m) && captured_has("mesh-test-"));
}

int main(void) {
    serialized_reads_versions_3_and_4();
    serialized_reads_all_arrays_in_both_precisions();
    serialized_flag_of_face_normals_drops_normals();
    serialized_reads_one_mesh_of_many();
    serialized_refuses_bad_values();
    serialized_refuses_counts_the_file_cannot_hold();
    serialized_refuses_bad_tables();
    serialized_refuses_every_truncation();
    return check_result();
}
