// SPDX-License-Identifier: Apache-2.0
// Cryptomatte layers (J. Friedman and A. C. Jones 2015; specification 1.2.0 of Psyop): masks of every
// object and material, antialiased by the picture's own samples.
//
// They are traced by themselves when the picture is written, from its first samples: they need no
// place in the film's sums and are the same after a resume.
#pragma once

#include "driver/job.h"

enum { CRYPTOMATTE_OBJECT = 1, CRYPTOMATTE_MATERIAL = 2, CRYPTOMATTE_SAMPLES = 256 };

// Attribute: seed, first sample and number of the samples that the layers are of.
#define CRYPTOMATTE_SAMPLES_OF "relume.cryptomatteSamples"

// Bits from "object,material"; false after an error message.
bool cryptomatte_parse(const char *list, uint32_t *kinds);
// Whether it may write channels under that name.
bool cryptomatte_is_layer(const char *name);
// Appends the layers to a picture of the job. false: stopped.
bool cryptomatte_add(const struct job *job, uint32_t kinds, uint64_t samples, struct image *im);

// The attribute of a layer that the specification calls so.
void cryptomatte_key(const char *layer, const char *what, char key[IMAGE_NAME_SIZE]);
// Appends the channels of a layer, black.
void cryptomatte_add_channels(struct image *im, const char *layer);
