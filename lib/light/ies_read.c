// SPDX-License-Identifier: Apache-2.0
// Reader of LM-63 files. Layout of all editions: a line that names the edition (none in 1986), lines
// of labels or [KEYWORD]s, the line TILT=, and then numbers, cut into lines at will: lamps, lumens of
// a lamp, multiplier, numbers of vertical and horizontal angles, type, unit of length, width,
// length, height; ballast factor, a further factor (1986, 1991: of ballast and lamp photometry; later
// kept free), watts; vertical angles, horizontal angles, and candela, vertical angles fastest.
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"
#include "base/text.h"
#include "light/ies_profile.h"

enum { MOST_VALUES = 1 << 24 };

struct ies_reader {
    const char *path;
    const char *p;    // next to read
    const char *seen; // lines up to here are counted
    int line;
};

static struct where here(struct ies_reader *r) {
    for (; r->seen < r->p; r->seen++)
        r->line += *r->seen == '\n';
    return (struct where){r->path, r->line};
}

static bool next_number(struct ies_reader *r, const char *what, double *value) {
    char found[32];
    while (text_is_space(*r->p) || *r->p == ',')
        r->p++;
    if (text_number(&r->p, value) && *value >= -1e30 && *value <= 1e30 &&
        (*r->p == '\0' || *r->p == ',' || *r->p == 0x1a || text_is_space(*r->p)))
        return true;
    log_error_at(here(r), "found \"%s\", expected %s", text_excerpt(r->p, found, sizeof found),
                 what);
    return false;
}

static bool next_count(struct ies_reader *r, const char *what, double least, double most,
                       uint32_t *count) {
    double v;
    if (!next_number(r, what, &v))
        return false;
    if (v >= least && v <= most && v == (double)(uint32_t)v) {
        *count = (uint32_t)v;
        return true;
    }
    log_error_at(here(r), "%s is %g, expected a whole number from %g to %g", what, v, least, most);
    return false;
}

static bool next_angles(struct ies_reader *r, const char *what, float *angles, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        double v;
        if (!next_number(r, what, &v))
            return false;
        angles[i] = (float)v;
        if (v < -360 || v > 360 || (i > 0 && !(angles[i] > angles[i - 1]))) {
            log_error_at(here(r), "%s %u is %g, expected them increasing and within -360 to 360",
                         what, i + 1, v);
            return false;
        }
    }
    return true;
}

static const char *end_of_line(const char *p) {
    while (*p && *p != '\n' && *p != '\r')
        p++;
    return p;
}

// Whether the further factor behind the ballast's counts: files of 1986 and 1991.
static bool is_old(const char *text) {
    if (strncmp(text, "IESNA91", 7) == 0)
        return true;
    return strncmp(text, "IESNA", 5) != 0 && strncmp(text, "IES:", 4) != 0;
}

// Lines up to and with TILT=; *word: what stands behind it.
static bool skip_labels(struct ies_reader *r, char word[16]) {
    while (*r->p) {
        const char *end = end_of_line(r->p);
        if (strncmp(r->p, "TILT=", 5) == 0) {
            const char *w = r->p + 5;
            while (text_is_blank(*w))
                w++;
            text_excerpt(w, word, 16);
            r->p = end;
            return true;
        }
        r->p = end + (*end != '\0');
    }
    log_error_at(here(r), "no line TILT= was found, expected one after the labels");
    return false;
}

// The lamp's factor at a tilt, between the pairs of TILT=INCLUDE.
static bool read_tilt(struct ies_reader *r, float degrees, float *factor) {
    uint32_t geometry, count;
    float *angles = NULL, *factors = NULL;
    if (!next_count(r, "lamp-to-luminaire geometry", 1, 3, &geometry) ||
        !next_count(r, "number of tilt angles", 1, 10000, &count))
        return false;
    angles = mem_array(count, sizeof *angles);
    factors = mem_array(count, sizeof *factors);
    bool ok = next_angles(r, "tilt angle", angles, count);
    for (uint32_t i = 0; ok && i < count; i++) {
        double v;
        ok = next_number(r, "a tilt factor", &v);
        factors[i] = (float)fmin(fmax(v, 0), 1e6);
    }
    if (ok) {
        uint32_t i = 0;
        while (i + 1 < count && angles[i + 1] < degrees)
            i++;
        const uint32_t j = i + 1 < count ? i + 1 : i;
        const float t = j > i ? clampf((degrees - angles[i]) / (angles[j] - angles[i]), 0, 1) : 0;
        *factor = lerpf(t, factors[i], factors[j]);
    }
    mem_free(angles);
    mem_free(factors);
    return ok;
}

static bool apply_tilt(struct ies_reader *r, float degrees, struct ies_profile *p) {
    char word[16];
    p->tilt = 1;
    if (!skip_labels(r, word))
        return false;
    if (strcmp(word, "INCLUDE") == 0)
        return read_tilt(r, degrees, &p->tilt);
    if (strcmp(word, "NONE") == 0 || degrees == 0)
        return true;
    log_error_at(here(r), "TILT=%s names another file, expected NONE or INCLUDE for a tilted lamp",
                 word);
    return false;
}

struct header {
    double multiplier;
    uint32_t type;
};

static bool read_header(struct ies_reader *r, bool old, struct ies_profile *p, struct header *h) {
    double lamps, lumens, length, ballast, further, watts;
    uint32_t unit;
    bool ok = next_number(r, "the number of lamps", &lamps) &&
              next_number(r, "the lumens of a lamp", &lumens) &&
              next_number(r, "the candela multiplier", &h->multiplier) &&
              next_count(r, "number of vertical angles", 1, 100000, &p->vertical_count) &&
              next_count(r, "number of horizontal angles", 1, 100000, &p->horizontal_count) &&
              next_count(r, "photometric type", 1, 3, &h->type) &&
              next_count(r, "unit of length", 1, 2, &unit);
    for (int i = 0; ok && i < 3; i++)
        ok = next_number(r, "width, length or height", &length);
    ok = ok && next_number(r, "the ballast factor", &ballast) &&
         next_number(r, "the factor after the ballast's", &further) &&
         next_number(r, "the watts", &watts);
    if (!ok)
        return false;
    h->multiplier *= ballast * (old ? further : 1);
    p->type = (enum ies_type)h->type;
    if ((uint64_t)p->vertical_count * p->horizontal_count > MOST_VALUES) {
        log_error_at(here(r), "%u x %u angles, expected at most %d", p->vertical_count,
                     p->horizontal_count, MOST_VALUES);
        return false;
    }
    if (h->multiplier >= 0 && h->multiplier <= 1e30)
        return true;
    log_error_at(here(r), "multiplier and ballast factor make %g, expected 0 to 1e30",
                 h->multiplier);
    return false;
}

// Angles outside of what a type can have would never be looked up.
static bool check_angles(struct ies_reader *r, const struct ies_profile *p) {
    const float first = p->vertical[0], last = p->vertical[p->vertical_count - 1];
    const bool c = p->type == IES_TYPE_C;
    if (first >= (c ? 0 : -90.01f) && last <= (c ? 180.01f : 90.01f))
        return true;
    log_error_at(here(r), "vertical angles from %g to %g, expected %s for type %c", (double)first,
                 (double)last, c ? "0 to 180" : "-90 to 90", "CBA"[p->type - 1]);
    return false;
}

static bool read_candela(struct ies_reader *r, float factor, struct ies_profile *p) {
    const size_t count = (size_t)p->vertical_count * p->horizontal_count;
    // a number takes at least two bytes: no more memory than the file can fill
    if (count > strlen(r->p) / 2 + 1) {
        log_error_at(here(r), "the file ends early, expected %zu candela values", count);
        return false;
    }
    p->candela = mem_array(count, sizeof *p->candela);
    for (size_t i = 0; i < count; i++) {
        double v;
        if (!next_number(r, "a candela value", &v))
            return false;
        p->negative += v < 0;
        p->candela[i] = (float)fmin(fmax(v, 0) * (double)factor, 1e30);
    }
    return true;
}

static bool read_profile(struct ies_reader *r, float tilt, struct ies_profile *p) {
    struct header h;
    const bool old = is_old(r->p);
    if (!apply_tilt(r, tilt, p) || !read_header(r, old, p, &h))
        return false;
    p->vertical = mem_array(p->vertical_count, sizeof *p->vertical);
    p->horizontal = mem_array(p->horizontal_count, sizeof *p->horizontal);
    return next_angles(r, "vertical angle", p->vertical, p->vertical_count) &&
           next_angles(r, "horizontal angle", p->horizontal, p->horizontal_count) &&
           check_angles(r, p) && read_candela(r, (float)h.multiplier * p->tilt, p);
}

bool ies_profile_read(const char *path, float tilt_degrees, struct ies_profile *p) {
    size_t size;
    *p = (struct ies_profile){0};
    char *text = file_read(path, 64 << 20, &size);
    if (!text)
        return false;
    struct ies_reader r = {path, text, text, 1};
    const bool ok = read_profile(&r, tilt_degrees, p);
    if (!ok)
        ies_profile_finish(p);
    mem_free(text);
    return ok;
}
