// SPDX-License-Identifier: Apache-2.0
#include "driver/point_list.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "base/text.h"

enum { BUFFER = 1 << 16 }; // a line is shorter

struct point_list {
    int file, line;
    const char *name;
    bool ended;
    size_t used, begin;      // bytes there are, and those that have been read
    char bytes[BUFFER + 2];  // the last line may lack its end
};

struct point_list *point_list_open(int file, const char *name) {
    struct point_list *l = mem_array(1, sizeof *l);
    l->file = file;
    l->name = name;
    return l;
}

void point_list_close(struct point_list *l) {
    mem_free(l);
}

// Whether bytes can be had without waiting.
static bool is_ready(const struct point_list *l) {
    struct pollfd p = {.fd = l->file, .events = POLLIN};
    return poll(&p, 1, 0) > 0;
}

// Takes more bytes; waits for them. false after an error message.
static bool take_bytes(struct point_list *l) {
    memmove(l->bytes, l->bytes + l->begin, l->used - l->begin);
    l->used -= l->begin;
    l->begin = 0;
    if (l->used == BUFFER) {
        log_error("%s:%d: the line is longer than %d characters", l->name, l->line + 1, BUFFER);
        return false;
    }
    ssize_t n;
    do
        n = read(l->file, l->bytes + l->used, BUFFER - l->used);
    while (n < 0 && errno == EINTR);
    if (n < 0) {
        log_error("%s: %s", l->name, strerror(errno));
        return false;
    }
    l->used += (size_t)n;
    l->ended = n == 0;
    if (l->ended && l->used > 0 && l->bytes[l->used - 1] != '\n')
        l->bytes[l->used++] = '\n';
    return true;
}

// The next whole line, ended by a zero byte; NULL: there is none yet.
static char *next_line(struct point_list *l) {
    char *line = l->bytes + l->begin;
    char *end = memchr(line, '\n', l->used - l->begin);
    if (!end)
        return NULL;
    *end = '\0';
    l->begin = (size_t)(end + 1 - l->bytes);
    l->line++;
    return line;
}

static bool fail(const struct point_list *l, const char *found, const char *expected) {
    char word[64];
    log_error("%s:%d: found '%s', expected %s", l->name, l->line,
              *found ? text_excerpt(found, word, sizeof word) : "end of line", expected);
    return false;
}

static const char *skip_blanks(const char *p) {
    while (text_is_space(*p) || *p == ',')
        p++;
    return p;
}

// *empty: there is no point in the line.
static bool parse(const struct point_list *l, const char *line, struct sensor_point *out,
                  bool *empty) {
    static const char numbers[] = "six finite numbers: a position, and a normal or direction";
    double v[6];
    const char *p = skip_blanks(line);
    *empty = *p == '\0' || *p == '#';
    if (*empty)
        return true;
    for (int i = 0; i < 6; i++) {
        const char *word = p = skip_blanks(p);
        if (!text_number(&p, &v[i]) || !(fabs(v[i]) < 1e30))
            return fail(l, word, numbers);
    }
    p = skip_blanks(p);
    if (*p != '\0' && *p != '#')
        return fail(l, p, "the end of the line after six numbers");
    const double size = sqrt(v[3] * v[3] + v[4] * v[4] + v[5] * v[5]);
    if (!(size > 0))
        return fail(l, "0 0 0", "a normal or direction that has a length");
    for (int i = 0; i < 3; i++)
        out->p[i] = v[i];
    out->d = normalize(v3((float)(v[3] / size), (float)(v[4] / size), (float)(v[5] / size)));
    return true;
}

uint32_t point_list_read(struct point_list *l, struct sensor_point *points, uint32_t most,
                         bool *good) {
    uint32_t count = 0;
    *good = true;
    while (count < most) {
        bool empty;
        const char *line = next_line(l);
        if (!line) {
            if (l->ended || (count > 0 && !is_ready(l)))
                break;
            *good = take_bytes(l);
        } else {
            *good = parse(l, line, &points[count], &empty);
            count += *good && !empty;
        }
        if (!*good)
            break;
    }
    return count;
}
