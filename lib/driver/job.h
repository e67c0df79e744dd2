// SPDX-License-Identifier: Apache-2.0
// A picture from a scene file: everything between the command line and the finished image.
#pragma once

#include "base/options.h"
#include "driver/light_groups.h"
#include "driver/method.h"
#include "driver/receiver.h"
#include "driver/render.h"

struct job_options {
    const char *scene;
    struct scene_options reading; // registries are filled in by job_open
    struct receiver receiver;
    int spp;                      // 0: what the scene asks for, else 64; no limit where time or
                                  // noise is one
    uint64_t samples[2];          // first and end of a range on block boundaries; 0, 0: all
    double seconds, noise;        // further limits (driver/render.h); 0: none
    int crop[4];                  // x0, y0, x1, y1; all 0: the scene's
    int max_depth;                // 0: the scene's
    uint32_t seed;
    int threads;
    const char *aovs;             // "albedo,N" or NULL
    bool variance, light_groups, paths;
    double clamp;                 // of indirect light (sink/film.h); 0: none
    const char *cryptomatte;      // "object,material" or NULL
    bool may_leak;                // as scene->may_leak, whatever the file says
    const char *light;            // the only light or group of lights that shines; NULL: all
    bool adaptive;                // samples go where a pilot finds noise
    // Changes the scene between reading it and building the world; or NULL.
    void (*edit_scene)(struct scene *s, void *user);
    void *edit_user;
    const volatile sig_atomic_t *stop;
    void (*progress)(void *user, double done, const struct film *film);
    void *user;
};

// A scene that is ready to be rendered, once or many times.
struct job {
    struct scene *scene;
    struct world *world;
    struct light_groups groups;
    struct filter_sampler filter;
    struct film_options film;
    struct render_options render;
    struct method method;  // of rendering
    uint32_t cryptomatte;  // layers (driver/cryptomatte.h)
    struct sample_map map; // of adaptive sampling; its memory is the scene's
    uint64_t defines_hash; // of the -D values
    double load_seconds; // reading and building
    uint64_t triangles;
};

// The registries of everything a scene may name.
struct scene_registries job_registries(void);

// Texts "NAME=VALUE" of -D as defines; the names live in the arena. NULL after an error message.
struct scene_define *defines_parse(const struct option_list *texts, struct arena *arena);

// The range "A:B" of --samples, or NULL: all, as 0 and 0. false after an error message.
bool samples_parse(const char *text, uint64_t samples[2]);

// Reads and builds. false after an error message, with nothing to close.
bool job_open(struct job *job, const struct job_options *options);
void job_close(struct job *job);
// An empty film for the job's picture; film_destroy it when done.
struct film *job_film(const struct job *job);
// Traces what is missing in the film with job->render.
void job_trace(struct job *job, struct film *film, struct render_result *result);
// Both.
struct film *job_render(struct job *job, struct render_result *result);

// The picture's size, names and attributes; its pixels are film_rows. false after an error message.
bool job_image_head(const struct job *job, const struct film *film,
                    const struct render_result *result, struct image *im);
// The picture with its layers, masks too. false after an error message.
bool job_image(const struct job *job, const struct film *film, const struct render_result *result,
               struct image *im);
