// SPDX-License-Identifier: Apache-2.0
// Uniting films that were rendered apart: ranges of samples, seeds and crops of one picture.
//
// The sums meet in the same tree in which one run would have summed them (sink/sums.h), so the
// result has the bits of that run.
#pragma once

#include "base/json.h"
#include "base/mem.h"
#include "sink/film.h"

struct film_union {
    struct film *film;
    struct json *head; // driver/film_head.h
    struct arena arena;
};

// Unites the journals of `count` pictures; a path is that of the picture or of its journal. false
// after an error message: not readable, not of one picture, overlapping, or with gaps.
bool merge_films(struct film_union *u, const char *const *paths, size_t count);
void film_union_finish(struct film_union *u);
