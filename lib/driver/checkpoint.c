// SPDX-License-Identifier: Apache-2.0
#include "driver/checkpoint.h"

#include <inttypes.h>
#include <stdio.h>

#include "base/file.h"
#include "base/thread.h"

static const double MOST_COST = 0.03; // share of the time that keeping may take

// A picture says one seed; several are united by merge.
static bool seeds_agree(const struct checkpoint *c, const struct sums *sums) {
    const uint32_t seed = c->job->film.seed;
    for (size_t i = 0; i < sums->count; i++)
        if (sums->nodes[i].seed != seed) {
            log_error("%s: holds samples of seed %u, and --seed is %u; expected the same, or another "
                      "OUT.exr and `relume merge`", c->path, sums->nodes[i].seed, seed);
            return false;
        }
    return true;
}

// Takes up the sums of the journal that is there.
static bool restore(struct checkpoint *c, struct film *film) {
    struct json *head;
    struct sums sums;
    if (!file_exists(c->path)) {
        log_info("%s: is not there; starting afresh", c->path);
        return true;
    }
    if (!journal_read(c->path, &head, &sums))
        return false;
    const bool agrees = film_head_agrees(c->head, "this run", head, c->path, true) &&
                        seeds_agree(c, &sums);
    if (agrees) {
        film_restore(film, &sums);
        log_info("%s: going on from %" PRIu64 " samples per pixel", c->path, film_samples(film));
    }
    json_destroy(head);
    sums_finish(&sums);
    return agrees;
}

// The disk is full when the picture is to be written, or takes no journal: known now already, as far as
// a picture does not compress to a quarter of its colours.
static bool has_space(const struct checkpoint *c, const struct film *film) {
    enum { LEAST = 4096, COLOURS = 3 };
    const struct film_options *f = &c->job->film;
    const double pixels = (double)(f->x1 - f->x0) * (double)(f->y1 - f->y0);
    const double bytes = c->options.exr && c->options.exr->half ? 2 : 4;
    const double picture = LEAST + pixels * COLOURS * bytes / 4;
    const double journal = c->options.keep && !file_exists(c->path)
                               ? (double)film_values(film) * (double)sizeof(double) : 0;
    const double space = file_space(c->path);
    if (space < picture + journal)
        log_error("%s: cannot be written: the disk has %.3g MB free, and at least %.3g MB are needed%s",
                  c->options.output, space * 1e-6, (picture + journal) * 1e-6,
                  journal > 0 ? ", most of it for the journal" : "");
    return space >= picture + journal;
}

bool checkpoint_open(struct checkpoint *c, const struct checkpoint_options *options,
                     const struct job *job, struct film *film) {
    *c = (struct checkpoint){.options = *options, .job = job};
    c->head = film_head_create(job, film, options->command, options->version);
    if (!journal_path(options->output, c->path, sizeof c->path) || !has_space(c, film) ||
        (options->resume && !restore(c, film)))
        return false;
    c->keeping = options->keep;
    if (c->keeping && !options->resume && file_exists(c->path))
        log_warn("%s: is there from an earlier run and will be replaced; --resume goes on from it",
                 c->path);
    c->start = time_seconds();
    c->journal_interval = options->seconds;
    c->preview_interval = options->preview_seconds;
    c->next_journal = c->start + c->journal_interval;
    c->next_preview = c->start + c->preview_interval;
    return true;
}

// The journal begins with the first sums that are worth keeping.
static bool update_journal(struct checkpoint *c, const struct film *film) {
    struct sums_node node;
    const struct sums_node *last = film_short_block(film, &node) ? &node : NULL;
    if (!c->keeping)
        return true;
    if (c->journal) {
        c->keeping = journal_update(c->journal, film_sums(film), last);
    } else {
        c->journal = journal_create(c->path, c->head, film_sums(film), last);
        c->keeping = c->journal != NULL;
    }
    return c->keeping; // if not, what the file holds stays valid; the picture can still be had
}

// The next time, when doing it took so long.
static double next_time(double *interval, double took) {
    if (took / MOST_COST > *interval)
        *interval = took / MOST_COST;
    return time_seconds() + *interval;
}

void checkpoint_tick(struct checkpoint *c, const struct film *film) {
    const double now = time_seconds();
    if (c->options.seconds > 0 && c->keeping && now >= c->next_journal) {
        update_journal(c, film);
        c->next_journal = next_time(&c->journal_interval, time_seconds() - now);
    }
    if (c->options.preview_seconds > 0 && now >= c->next_preview) {
        const struct render_result so_far = {.seconds = now - c->start, .noise = film_noise(film)};
        const double before = time_seconds();
        checkpoint_picture(c, film, &so_far);
        c->next_preview = next_time(&c->preview_interval, time_seconds() - before);
    }
    c->spent += time_seconds() - now;
}

bool checkpoint_finish(struct checkpoint *c, const struct film *film) {
    return update_journal(c, film);
}

void checkpoint_close(struct checkpoint *c) {
    journal_close(c->journal);
    json_destroy(c->head);
    *c = (struct checkpoint){0};
}

bool checkpoint_picture(const struct checkpoint *c, const struct film *film,
                        const struct render_result *result) {
    // Masks and other primaries need a whole picture; others are made while they are written.
    const bool whole = c->job->cryptomatte || c->options.space != SPACE_REC709;
    struct image_exr_options exr = c->options.exr ? *c->options.exr : (struct image_exr_options){0};
    struct image im = {0};
    exr.rows = (struct image_rows){film_rows, film};
    bool written = whole ? job_image(c->job, film, result, &im)
                         : job_image_head(c->job, film, result, &im);
    if (written) {
        film_head_label(c->head, film, result->noise, &im);
        image_from_rec709(&im, c->options.space);
        written = image_write_exr(c->options.output, &im, &exr);
    }
    image_finish(&im);
    return written;
}
