// SPDX-License-Identifier: Apache-2.0
#include "budget.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/json.h"
#include "base/log.h"
#include "replay/budget.h"

bool budget_parse(const char *text, double *relmse) {
    char rest;
    if (sscanf(text, "relmse=%lf%c", relmse, &rest) == 1 && isfinite(*relmse) && *relmse > 0)
        return true;
    log_error("--budget %s: expected relmse=X, the relative squared error that storage may add", text);
    return false;
}

static void print_json(const struct budget_run *run, const struct budget_report *r) {
    struct json *j = json_new_object();
    json_add_text(j, "output", run->output);
    json_add_number(j, "budget", run->relmse);
    json_add_number(j, "storage_relmse", r->worst);
    json_add_number(j, "rgbe_relmse", r->rgbe);
    json_add_number(j, "noise_relmse", r->noise);
    json_add_number(j, "noise_change", r->noise_change);
    json_add_count(j, "bytes", (int64_t)r->bytes);
    json_add_count(j, "value_bytes", (int64_t)r->value_bytes);
    json_add_count(j, "float32_bytes", (int64_t)r->float_bytes);
    json_add_count(j, "rgbe_bytes", 4 * (int64_t)r->nonzero);
    struct json *rows = json_add_object(j, "rows");
    for (int way = 0; way < ROW_WAYS; way++)
        json_add_count(rows, row_ways[way]->name, (int64_t)r->rows[way]);
    json_print(j, false);
    json_destroy(j);
}

bool budget_run(const struct budget_run *run) {
    struct budget_report r;
    const struct budget_options o = {.relmse = run->relmse, .threads = run->threads,
                                     .no_halves = run->no_halves, .command = run->command};
    if (!budget_store(run->tensor, run->output, &o, &r))
        return false;
    if (!run->quiet)
        log_info("%s: %.1f MB of coefficients (%.1f as float32, %.1f as RGBE without zeros), %.1f with "
                 "halves; storage adds a relMSE of %.2g, noise is %.2g, told %+.1f %%", run->output,
                 (double)r.value_bytes * 1e-6, (double)r.float_bytes * 1e-6, (double)r.nonzero * 4e-6,
                 (double)r.bytes * 1e-6, r.worst, r.noise, 100 * r.noise_change);
    if (run->json)
        print_json(run, &r);
    return true;
}
