// SPDX-License-Identifier: Apache-2.0
// Spectra of pbrt as Rec.709, and parameters that may be textured.
#include <math.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "math/colour.h"
#include "scene/pbrt.h"

static void store(spectrum s, double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = (double)s[i] > 0 ? (double)s[i] : 0; // colours out of gamut are clipped
}

// Pairs of wavelength and value; wavelengths ascend.
static bool from_pairs(const double *pairs, size_t count, enum pbrt_colour kind, struct where at,
                       double out[3]) {
    const size_t n = count / 2;
    bool good = count % 2 == 0 && n > 0;
    double *lambda = mem_array(n, sizeof *lambda), *value = mem_array(n, sizeof *value);
    for (size_t i = 0; i < n; i++) {
        lambda[i] = pairs[2 * i];
        value[i] = pairs[2 * i + 1];
        good = good && (i == 0 || lambda[i] > lambda[i - 1]);
    }
    if (good)
        store(colour_from_samples(lambda, value, n, kind != PBRT_ILLUMINANT), out);
    else
        log_error_at(at, "a spectrum is pairs of ascending wavelengths and values");
    mem_free(lambda);
    mem_free(value);
    return good;
}

static bool from_file(struct pbrt *p, const char *name, enum pbrt_colour kind, struct where at,
                      double out[3]) {
    size_t size, count = 0, capacity = 0;
    double *pairs = NULL, v;
    const char *path = load_find_file(p->r, name, at);
    char *text = path ? file_read(path, (size_t)1 << 24, &size) : NULL;
    if (!text)
        return false;
    for (const char *s = text; *s;) {
        if (*s == '#')
            s += strcspn(s, "\n");
        else if (text_is_space(*s) || *s == ',')
            s++;
        else if (text_number(&s, &v)) {
            mem_grow(&pairs, &capacity, count + 1, sizeof *pairs);
            pairs[count++] = v;
        } else {
            break;
        }
    }
    const bool good = from_pairs(pairs, count, kind, at, out) && load_hash_file(p->r, path);
    mem_free(pairs);
    mem_free(text);
    return good;
}

// Spectra that pbrt knows by name and that have a colour of ours.
static bool from_name(struct pbrt *p, const char *name, enum pbrt_colour kind, struct where at,
                      double out[3]) {
    static const struct {
        const char *name;
        double kelvin; // 0: white
    } known[] = {{"stdillum-D65", 0}, {"illum-acesD60", 6000}, {"stdillum-D50", 5000},
                 {"stdillum-A", 2856}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strcmp(known[i].name, name) == 0) {
            const spectrum s = known[i].kelvin > 0 ? colour_blackbody(known[i].kelvin)
                                                   : spectrum_grey(1);
            store(s, out);
            return true;
        }
    return from_file(p, name, kind, at, out);
}

// pbrt divides by SpectrumToPhotometric: the luminance is then what "scale" says.
static void normalise(double c[3]) {
    const double y = 0.212671 * c[0] + 0.715160 * c[1] + 0.072169 * c[2];
    for (int i = 0; i < 3 && y > 0; i++)
        c[i] /= y;
}

bool pbrt_read_colour(struct pbrt *p, struct pbrt_call *c, const char *name, enum pbrt_colour kind,
                      double out[3], bool *good) {
    const struct pbrt_param *a = pbrt_find(c, "rgb|spectrum|blackbody", name, good);
    if (!a)
        return false;
    bool read = true;
    if (strcmp(a->type, "rgb") == 0) {
        memcpy(out, a->numbers, 3 * sizeof *out);
        for (int i = 0; i < 3; i++)
            read = read && out[i] >= 0 && out[i] < 1e30;
        if (!read)
            log_error_at(a->at, "\"rgb %s\" has a negative or infinite value", name);
        *good = *good && read;
        return read;
    }
    if (strcmp(a->type, "blackbody") == 0) {
        read = a->numbers[0] > 0 && a->numbers[0] < 1e9;
        if (read)
            store(colour_blackbody(a->numbers[0]), out);
        else
            log_error_at(a->at, "a blackbody has a temperature above 0 K");
    } else if (a->texts) {
        read = from_name(p, a->texts[0], kind, a->at, out);
    } else {
        read = from_pairs(a->numbers, a->count, kind, a->at, out);
    }
    if (read && kind == PBRT_ILLUMINANT)
        normalise(out);
    *good = *good && read;
    return read;
}

const char *pbrt_texture_id(struct pbrt *p, const char *name, bool scalar, struct where at) {
    const char *id = arena_printf(p->r->arena, "%s texture %s", scalar ? "float" : "spectrum", name);
    if (id_find(p->r, id))
        return id;
    log_error_at(at, "there is no %s texture \"%s\" before this line", scalar ? "float" : "spectrum",
                 name);
    return NULL;
}

bool pbrt_put_texture(struct pbrt *p, struct pbrt_call *c, const char *name, struct xml_node *out,
                      const char *ours, bool scalar) {
    bool good = true;
    const struct pbrt_param *a =
        pbrt_find(c, scalar ? "texture|float" : "texture|rgb|spectrum|blackbody", name, &good);
    if (!a)
        return good;
    if (strcmp(a->type, "texture") == 0) {
        const char *id = pbrt_texture_id(p, a->texts[0], scalar, a->at);
        if (id)
            pbrt_ref(p, out, ours, id);
        return id != NULL;
    }
    if (scalar) {
        tree_number(p->r, out, ours, a->numbers[0]);
        return true;
    }
    double colour[3];
    if (!pbrt_read_colour(p, c, name, PBRT_REFLECTANCE, colour, &good))
        return false;
    tree_triple(p->r, out, "rgb", ours, colour);
    return true;
}
