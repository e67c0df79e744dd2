// SPDX-License-Identifier: Apache-2.0
// A study: a scene in many settings, each rendered several times, and the error of each against one
// reference, parted into bias and variance.
#pragma once

#include "driver/study_error.h"
#include "driver/study_settings.h"
#include "math/line_fit.h"
#include "math/repeats.h"

enum study_metric { STUDY_RELMSE, STUDY_VARIANCE, STUDY_BIAS2 };
extern const char *const study_metric_names[]; // NULL-terminated

enum { STUDY_MOST_RUNS = 4000 };

struct study_options {
    struct job_options job;  // scene, size, -D values, seed, threads, stop
    const struct study_factors *factors;
    int repeat;              // runs of each setting, >= 2 and at most STUDY_MOST_RUNS
    bool even;               // settings of fewer samples run more often, so that all take as many:
                             // rare bright samples then weigh on all points alike
    const char *reference;   // picture; NULL: it is rendered, as the scene says
    int reference_spp;       // 0: 16 times the most of the study, at least 1024
    bool has_target;
    enum study_metric metric;
    double target;
    const char *directory;   // for everything that is written
    const char *command, *version;
    void (*progress)(void *user, double done, const char *note);
    void *user;
};

struct study_run {
    uint32_t seed;
    double seconds, cpu_seconds; // wall clock; processor time of all threads
    uint64_t samples;
    double relmse; // of this run alone, the reference's noise taken off
};

// One setting and what it gave. Errors are relative: means of squares over ref^2 + 1e-3 mean(ref)^2.
struct study_point {
    const char *values[STUDY_MOST_FACTORS]; // NULL: this method has no such setting
    struct study_run *runs;
    int run_count;
    struct repeats error;
    double seconds, fastest, slowest; // median and ends of the runs
    double cpu_seconds;       // mean of the runs
    double load_seconds;      // reading the scene and building
    double samples;           // of a pixel, in a run
    double bytes;             // what the method says it keeps, else the most memory in use, beyond
                              // what was before reading; 0: not known
    bool front_seconds, front_bytes; // nothing else is as good in both
    size_t series;
    char *thumbnail, *difference;    // of the first run: PNG as data: URIs
};

enum study_axis { STUDY_ALONG, STUDY_SECONDS, STUDY_BYTES, STUDY_AXES };

// Points that differ in one factor only.
struct study_series {
    char *name;
    size_t *points; // in the order of that factor
    size_t count;
    bool fitted[STUDY_AXES];
    struct line_fit fits[STUDY_AXES]; // log10 of relMSE over log10 of the axis
    bool variance_fitted;
    struct line_fit variance_fit;     // of the variance over the factor
};

struct study {
    const struct study_options *options;
    struct study_reference reference;
    char *reference_thumbnail;
    struct study_point *points;
    size_t point_count;
    struct study_series *series;
    size_t series_count;
    int along;          // the factor that a series goes along; -1: there is none
    size_t cheapest;    // the quickest point that reaches the target; point_count: none does
    bool noisy_reference; // its noise is no longer small against the least error
    bool misused;       // study_run failed for settings that make no sense
    bool stopped;       // some runs are missing
    struct arena arena;
};

// Renders. Points without two runs are left out. false after an error message.
bool study_run(const struct study_options *options, struct study *study);
void study_finish(struct study *study);

// Sorts the points into series, fits lines and finds fronts and the target.
void study_analyse(struct study *study);
double study_metric_of(const struct study_point *p, enum study_metric metric);
// The value of a point on an axis.
double study_position(const struct study *study, const struct study_point *p, enum study_axis axis);
// "sampler=sobol spp=16": what is set, in the factors that vary.
void study_label(const struct study *study, const struct study_point *p, char *text, size_t size);
