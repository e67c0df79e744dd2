// SPDX-License-Identifier: Apache-2.0
// What a film's sums are sums of: the head of its journal, and the attributes of its picture.
//
// Two films may be united, or one gone on with, when all that decides a sample's value is the same:
// the scene's files, -D values, size, sensor, integrator, sampler and layers.
#pragma once

#include "base/json.h"
#include "driver/job.h"

// command and version: for whoever reads the file. json_destroy it.
struct json *film_head_create(const struct job *job, const struct film *film, const char *command,
                              const char *version);
// Makes the head that of a film with another crop.
void film_head_set_crop(struct json *head, const struct film *film, const struct film_options *o);
// Whether sums under these heads go together; `crop` tells whether the crops must agree too. false
// after an error message that names what differs.
bool film_head_agrees(const struct json *a, const char *path_a, const struct json *b,
                      const char *path_b, bool crop);
// The film that a head describes, for making a picture of its sums. The strings of the options
// belong to head and arena. false after an error message: the head of `path` is damaged.
bool film_head_options(const struct json *head, const char *path, struct film_options *options,
                       struct arena *arena);
// Writes what the head says, and the film's samples and noise (film_noise), as attributes of a picture;
// a crop gets its place in the whole.
void film_head_label(const struct json *head, const struct film *film, double noise,
                     struct image *im);
