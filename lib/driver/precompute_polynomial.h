// SPDX-License-Identifier: Apache-2.0
// Precomputing how a picture depends on its materials, with all bounces: symbolic path tracing into a
// tensor whose coefficients stand for curves of what is seen and for products of what lights it.
//
// Samples come in passes, each of which leaves a whole tensor in place of the one before. A tensor
// that keeps its sums is its own checkpoint: whatever killed a run, what is there is valid and can be
// gone on with. Sums are exact (sink/edit_sums.h), so passes cannot be told from the result.
#pragma once

#include "driver/edit_groups.h"
#include "driver/job.h"
#include "integrator/path.h"
#include "integrator/symbolic.h"
#include "sink/edit_sums.h"

enum polynomial_tail {
    TAIL_NONE,   // light that scatters more often is left out
    TAIL_FROZEN, // it scatters from the materials as they are, and adds to the same coefficients
    TAIL_GEOMETRIC, // the last bounce stands for it, too (driver/polynomial_pilot.h)
};

extern const char *const polynomial_tails[]; // "none", "frozen", "geometric", NULL

// What edits are at later hops.
enum polynomial_later {
    LATER_LAMBERTIAN, // surfaces are Lambertian ones of the same albedo
    LATER_KEPT,       // they keep the shape of their reflection and change its amount
    LATER_TERMS,      // each of their terms does, for itself
};

extern const char *const polynomial_laters[]; // "lambertian", "kept", "terms", NULL

struct polynomial_options {
    struct job_options job;     // scene, samples, size, ...; edit_scene is taken
    const char *const *edit;    // materials to be made editable
    size_t edit_count;
    const char *const *group;   // objects with one factor at later hops (driver/edit_classes.h)
    size_t group_count;
    uint32_t bounces;           // scattering events that materials can be edited at
    uint32_t series[EDIT_MOST_BOUNCES]; // most bins of a curve at each of them
    enum polynomial_tail tail;
    enum polynomial_later later;
    const char *output;
    enum tensor_storage storage;
    double most_memory;         // bytes the sums of tiles may take; 0: half of what there is
    bool keep;                  // the sums too, so that samples can be added
    bool resume;                // go on from the output, if it is there
    double checkpoint;          // seconds between tensors that replace one another; 0: only the last
    bool dry_run;               // only say what it would take
    const char *command, *version;
    void (*progress)(void *user, double done);
    void *user;
};

struct polynomial_report {
    uint32_t objects, groups, coefficients; // coefficients of all blocks together
    uint64_t file_bytes, sums_bytes; // of the tensor; of the sums of tiles that are worked on
    uint64_t samples, paths, rays, rejected;
    double seconds;                  // spent tracing; dry run: expected
    double noise;                    // of the picture as it is; negative: not asked for
    bool stopped;                    // before the samples that were asked for, or short of their noise
};

// All ranks together (driver/ranks.h); only rank 0 writes and reports. false after an error message.
bool precompute_polynomial(const struct polynomial_options *o, struct polynomial_report *report);

// ---- its parts, as tests need them --------------------------------------------------------------

// A scene that is ready to be traced symbolically.
struct polynomial {
    struct job job;
    struct edit_plan plan;
    double *(*albedos)[FORM_TERMS]; // of terms (driver/polynomial_describe.h)
    struct edit_classes classes;
    struct edit_groups groups;
    struct symbolic response, survey;
    struct symbolic_object *objects;
    struct path path;          // the integrator's settings
    double radius[CURVE_CHANNELS]; // of a geometric tail; else 0
    struct object integrator;
    struct tracer_options tracer;
    struct arena arena;
};

// false after an error message, with nothing to close.
bool polynomial_open(struct polynomial *p, const struct polynomial_options *o);
void polynomial_close(struct polynomial *p);
