// SPDX-License-Identifier: Apache-2.0
#include "driver/limits.h"

static double larger(double a, double b) {
    return a > b ? a : b;
}

bool limits_go_on(const struct render_options *o, const struct film *film, struct limits_state *s) {
    if (film_next(film) >= o->end || (o->tracer.stop && *o->tracer.stop))
        return false;
    if (o->seconds > 0 && s->seconds >= o->seconds)
        return false;
    if (o->noise > 0 && film_next(film) % FILM_BLOCK == 0) {
        s->noise = film_noise(film);
        return s->noise < 0 || s->noise > o->noise;
    }
    return true;
}

double limits_share(const struct render_options *o, const struct film *film,
                    const struct limits_state *s) {
    const double first = (double)film_first(film);
    double share = ((double)film_next(film) - first) / ((double)o->end - first);
    if (o->seconds > 0)
        share = larger(share, s->seconds / o->seconds);
    if (o->noise > 0 && s->noise > 0)
        share = larger(share, o->noise / s->noise * (o->noise / s->noise));
    return share < 1 ? share : 1;
}

bool limits_missed(const struct render_options *o, const struct film *film,
                   const struct limits_state *s) {
    if (o->noise > 0)
        return !(s->noise >= 0 && s->noise <= o->noise);
    return film_next(film) < o->end && !(o->seconds > 0 && s->seconds >= o->seconds);
}
