// SPDX-License-Identifier: Apache-2.0
#include "replay_report.h"

#include "base/log.h"
#include "base/thread.h"
#include "replay/measure.h"

bool replay_measure(const struct replay_measured *m, struct replay_timing *t) {
    double product[REPLAY_REPEATS], whole[REPLAY_REPEATS];
    for (int i = 0; i < REPLAY_REPEATS; i++) {
        const double start = time_seconds();
        if (!m->product(m->ctx))
            return false;
        product[i] = time_seconds() - start;
        if (!m->frame(m->ctx))
            return false;
        whole[i] = time_seconds() - start;
    }
    t->product = measure_median(product, REPLAY_REPEATS);
    t->frame = measure_median(whole, REPLAY_REPEATS);
    return true;
}

void replay_count(const struct tensor *t, struct replay_timing *timing) {
    for (uint32_t i = 0; i < t->block_count; i++) {
        timing->pixels += t->blocks[i].pixel_count;
        timing->coefficients += t->blocks[i].coefficients;
    }
}

void replay_report(const struct replay_values *v, const struct replay_timing *t, struct json *out) {
    const double gb = (double)t->bytes * 1e-9, limit = v->time ? measure_bandwidth(v->threads) : 0;
    if (!v->quiet && t->noise >= 0)
        log_info("%s: %llu coefficients on %s, first frame %.1f ms, noise %.2f %%", v->output,
                 (unsigned long long)t->coefficients, t->device, t->first * 1e3, t->noise * 100);
    if (!v->quiet && v->time)
        log_info("product %.2f ms (%.1f GB/s; the machine reads %.1f GB/s), frame %.2f ms",
                 t->product * 1e3, gb / t->product, limit * 1e-9, t->frame * 1e3);
    json_add_text(out, "output", v->output);
    json_add_text(out, "device", t->device);
    json_add_count(out, "pixels", (int64_t)t->pixels);
    json_add_count(out, "coefficients", (int64_t)t->coefficients);
    if (t->noise >= 0)
        json_add_number(out, "noise", t->noise);
    json_add_number(out, "first_frame_seconds", t->first);
    if (!v->time)
        return;
    json_add_count(out, "bytes", (int64_t)t->bytes);
    json_add_number(out, "product_seconds", t->product);
    json_add_number(out, "frame_seconds", t->frame);
    json_add_number(out, "gigabytes_per_second", gb / t->product);
    json_add_number(out, "machine_gigabytes_per_second", limit * 1e-9);
}
