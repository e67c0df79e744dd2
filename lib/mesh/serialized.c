// SPDX-License-Identifier: Apache-2.0
// Mitsuba's .serialized meshes, versions 3 and 4: several in one file, each a header of four bytes
// and a zlib stream, the offsets of all at the end. Little-endian.
//
//   uint16 0x041C, uint16 version; compressed from here: uint32 flags, name up to a zero byte
//   (version 4), uint64 vertices, uint64 triangles, then float or double arrays: positions,
//   normals, uvs, colours (each where its flag is set), uint32 indices
//   at the end of the file: offsets of all meshes, uint64 (version 4) or uint32 (3), uint32 count
//
// As in Mitsuba v of texture coordinates is not flipped by default, and vertex normals are computed
// when there are none. Beyond Mitsuba 3: colours become the attribute vertex_color, and the flag
// for face normals is obeyed.
#include <limits.h>
#include <math.h>
#include <string.h>
#include <zlib.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"
#include "mesh/reader.h"

enum {
    FILE_MAGIC = 0x041c,
    HAS_NORMALS = 0x1,
    HAS_UVS = 0x2,
    HAS_COLORS = 0x8,
    FACE_NORMALS = 0x10,
    DOUBLE_PRECISION = 0x2000,
    KNOWN_FLAGS = 0x301f, // with 0x4 (tangents, never stored) and 0x1000 (single precision)
    MOST_NAME = 4096,
    MOST_RATIO = 1032, // deflate cannot do better (zlib, Technical Details)
    MOST_BYTES = 1 << 30, // of one array
};

struct stream {
    const char *path;
    z_stream z;
};

static uint64_t little(const unsigned char *p, int bytes) {
    uint64_t x = 0;
    for (int i = bytes - 1; i >= 0; i--)
        x = x << 8 | p[i];
    return x;
}

static bool fail_corrupt(const struct stream *s) {
    log_error("%s: has damaged or truncated compressed data%s%s", s->path, s->z.msg ? ": " : "",
              s->z.msg ? s->z.msg : "");
    return false;
}

static bool read_bytes(struct stream *s, void *to, size_t n) {
    s->z.next_out = to;
    while (n > 0) {
        s->z.avail_out = n < MOST_BYTES ? (uInt)n : MOST_BYTES;
        const uInt before = s->z.avail_out;
        const int status = inflate(&s->z, Z_SYNC_FLUSH);
        n -= before - s->z.avail_out;
        if (n > 0 && (status != Z_OK || before == s->z.avail_out))
            return fail_corrupt(s);
    }
    s->z.next_out = NULL;
    return true;
}

static bool read_integer(struct stream *s, int bytes, uint64_t *out) {
    unsigned char b[8];
    if (!read_bytes(s, b, (size_t)bytes))
        return false;
    *out = little(b, bytes);
    return true;
}

static bool skip_name(struct stream *s) {
    char c;
    for (int i = 0; i < MOST_NAME; i++) {
        if (!read_bytes(s, &c, 1))
            return false;
        if (c == '\0')
            return true;
    }
    log_error("%s: has a name of more than %d characters", s->path, MOST_NAME);
    return false;
}

static float decode_float(const unsigned char *p, size_t size) {
    const uint64_t bits = little(p, (int)size);
    if (size == sizeof(double)) {
        double d;
        memcpy(&d, &bits, sizeof d);
        return (float)d;
    }
    const uint32_t bits32 = (uint32_t)bits;
    float f;
    memcpy(&f, &bits32, sizeof f);
    return f;
}

// count finite numbers of 4 or 8 bytes
static bool read_floats(struct stream *s, size_t size, size_t count, const char *what, float *to) {
    unsigned char chunk[8192];
    for (size_t done = 0; done < count;) {
        const size_t most = sizeof chunk / size, n = count - done < most ? count - done : most;
        if (!read_bytes(s, chunk, n * size))
            return false;
        for (size_t i = 0; i < n; i++, done++) {
            to[done] = decode_float(chunk + i * size, size);
            if (!isfinite(to[done])) {
                log_error("%s: found %g as number %zu of the %s, expected a finite number of "
                          "single precision", s->path, (double)to[done], done, what);
                return false;
            }
        }
    }
    return true;
}

static bool read_indices(struct stream *s, struct mesh *m) {
    unsigned char b[12 * 512];
    for (uint32_t done = 0; done < m->triangle_count;) {
        const uint32_t left = m->triangle_count - done, n = left < 512 ? left : 512;
        if (!read_bytes(s, b, 12 * (size_t)n))
            return false;
        for (uint32_t i = 0; i < 3 * n; i++) {
            const uint32_t index = (uint32_t)little(b + 4 * i, 4);
            if (index >= m->vertex_count) {
                log_error("%s: found the index %u in triangle %u, expected one of the %u vertices",
                          s->path, index, done + i / 3, m->vertex_count);
                return false;
            }
            m->indices[done + i / 3][i % 3] = index;
        }
        done += n;
    }
    return true;
}

// Refuses what the rest of the file cannot hold, before memory is taken for it.
static bool check_counts(const struct stream *s, uint64_t vertices, uint64_t triangles,
                         uint64_t flags) {
    const uint64_t size = flags & DOUBLE_PRECISION ? 8 : 4;
    const uint64_t numbers = 3 + (flags & HAS_NORMALS ? 3 : 0) + (flags & HAS_UVS ? 2 : 0) +
                             (flags & HAS_COLORS ? 3 : 0);
    const uint64_t most = MOST_BYTES / (3 * sizeof(float));
    if (vertices <= most && triangles <= most &&
        vertices * numbers * size + triangles * 12 <= ((uint64_t)s->z.avail_in + 64) * MOST_RATIO)
        return true;
    log_error("%s: announces %llu vertices and %llu triangles, expected what the file can hold "
              "(and at most %llu)", s->path, (unsigned long long)vertices,
              (unsigned long long)triangles, (unsigned long long)most);
    return false;
}

static bool read_arrays(struct stream *s, uint64_t flags, struct mesh *m) {
    const size_t size = flags & DOUBLE_PRECISION ? 8 : 4, n = m->vertex_count;
    m->positions = mesh_alloc_positions(n);
    if (!read_floats(s, size, 3 * n, "positions", m->positions[0]))
        return false;
    if (flags & HAS_NORMALS) {
        m->normals = mem_array(n, sizeof *m->normals);
        if (!read_floats(s, size, 3 * n, "normals", m->normals[0]))
            return false;
    }
    if (flags & HAS_UVS) {
        m->uvs = mem_array(n, sizeof *m->uvs);
        if (!read_floats(s, size, 2 * n, "texture coordinates", m->uvs[0]))
            return false;
    }
    if (flags & HAS_COLORS) {
        float *colors = mesh_add_attribute(m, s->path, "vertex_color", 3, n)->data;
        if (!read_floats(s, size, 3 * n, "colours", colors))
            return false;
    }
    m->indices = mem_array(m->triangle_count, sizeof *m->indices);
    return read_indices(s, m);
}

static bool read_stream(struct stream *s, int version, bool *face_normals, struct mesh *m) {
    uint64_t flags, vertices, triangles;
    if (!read_integer(s, 4, &flags) || (version == 4 && !skip_name(s)) ||
        !read_integer(s, 8, &vertices) || !read_integer(s, 8, &triangles))
        return false;
    if (flags & ~(uint64_t)KNOWN_FLAGS) {
        log_error("%s: found the flags 0x%llx, expected bits of 0x%x", s->path,
                  (unsigned long long)flags, KNOWN_FLAGS);
        return false;
    }
    if (!check_counts(s, vertices, triangles, flags))
        return false;
    m->vertex_count = (uint32_t)vertices;
    m->triangle_count = (uint32_t)triangles;
    *face_normals |= (flags & FACE_NORMALS) != 0;
    return read_arrays(s, flags, m);
}

// Where mesh number `index` begins. The table at the end is not needed for the first.
static bool find_mesh(const char *path, const unsigned char *data, size_t size, int version,
                      int index, size_t *offset) {
    const size_t width = version == 4 ? 8 : 4;
    const size_t count = size >= 8 ? little(data + size - 4, 4) : 0;
    *offset = 0;
    if (index == 0)
        return true;
    if (index < 0 || (size_t)index >= count || count > (size - 8) / width) {
        log_error("%s: has no mesh number %d, its table announces %zu (counted from 0)", path,
                  index, count);
        return false;
    }
    const uint64_t at = little(data + size - 4 - (count - (size_t)index) * width, (int)width);
    if (at >= size - 4) {
        log_error("%s: mesh number %d begins at byte %llu, expected less than the size of the "
                  "file, %zu", path, index, (unsigned long long)at, size);
        return false;
    }
    *offset = (size_t)at;
    return true;
}

static bool check_header(const char *path, const unsigned char *data, size_t size, size_t offset,
                         int *version) {
    const unsigned char *p = data + offset;
    *version = size - offset >= 4 ? (int)little(p + 2, 2) : 0;
    if (*version && little(p, 2) == FILE_MAGIC && (*version == 3 || *version == 4))
        return true;
    log_error("%s: has no header of a serialized mesh (0x041c, version 3 or 4) at byte %zu", path,
              offset);
    return false;
}

static bool read_data(const char *path, const unsigned char *data, size_t size, int index,
                      bool *face_normals, struct mesh *m) {
    struct stream s = {.path = path};
    int version;
    size_t offset;
    if (!check_header(path, data, size, 0, &version) ||
        !find_mesh(path, data, size, version, index, &offset) ||
        !check_header(path, data, size, offset, &version))
        return false;
    const size_t left = size - offset - 4;
    s.z.next_in = (Bytef *)(uintptr_t)(data + offset + 4); // zlib does not write there
    s.z.avail_in = left < UINT32_MAX ? (uInt)left : UINT32_MAX;
    if (inflateInit(&s.z) != Z_OK)
        return fail_corrupt(&s);
    const bool good = read_stream(&s, version, face_normals, m);
    inflateEnd(&s.z);
    return good;
}

static bool read_serialized(const char *path, const struct mesh_options *options, struct mesh *m) {
    *m = (struct mesh){0};
    struct mesh_options o = *options;
    size_t size = 0;
    const void *data = file_map(path, &size); // of many meshes one is read
    const bool good = data && read_data(path, data, size, o.shape_index, &o.face_normals, m);
    file_unmap(data, size);
    if (good && mesh_complete(m, path, &o, o.flip_uvs))
        return true;
    mesh_finish(m);
    return false;
}

// A file without a table at its end has one mesh, which begins where the table would say: at 0.
static bool count_serialized(const char *path, int *meshes) {
    size_t size = 0;
    const unsigned char *data = file_map(path, &size);
    int version;
    const bool good = data && check_header(path, data, size, 0, &version);
    *meshes = 1;
    if (good && size >= 8) {
        const size_t width = version == 4 ? 8 : 4, count = little(data + size - 4, 4);
        if (count > 0 && count <= (size - 8) / width && count <= INT_MAX &&
            little(data + size - 4 - count * width, (int)width) == 0)
            *meshes = (int)count;
    }
    file_unmap(data, size);
    return good;
}

static const char *const extensions[] = {"serialized", NULL};

const struct mesh_reader_type mesh_reader_serialized = {
    .entry = {.name = "serialized", .help = "Mitsuba's compressed meshes, several in a file"},
    .extensions = extensions,
    .read = read_serialized,
    .count = count_serialized,
};
