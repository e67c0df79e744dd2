// SPDX-License-Identifier: Apache-2.0
#include "driver/scene_info.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "driver/convergence.h"
#include "scene/summary.h"

// How often each entry of a kind is used, as an object.
static void add_uses(const struct scene_summary *s, const char *kind, const char *key,
                     struct json *out) {
    struct json *uses = json_add_object(out, key);
    for (uint32_t i = 0; i < s->use_count; i++)
        if (strcmp(s->uses[i].kind, kind) == 0)
            json_add_count(uses, s->uses[i].name, s->uses[i].count);
}

static void add_view(const struct job *job, struct json *out) {
    const struct scene *s = job->scene;
    const int crop[] = {job->film.x0, job->film.y0, job->film.x1, job->film.y1};
    json_add_text(out, "sensor", s->sensors[0]->type->name);
    json_add_count(out, "width", s->film.width);
    json_add_count(out, "height", s->film.height);
    struct json *array = json_add_array(out, "crop");
    for (int i = 0; i < 4; i++)
        json_append_number(array, crop[i]);
    json_add_text(out, "filter", s->filter->type->name);
    json_add_text(out, "sampler", s->sampler->type->name);
    json_add_count(out, "samples", job->render.tracer.spp);
    json_add_text(out, "integrator", s->integrator->type->name);
    json_add_text(out, "method", job->method.used);
    json_add_text(out, "method_asked", job->method.asked);
    json_add_text(out, "method_because", job->method.why);
}

// The integrator's numbers and switches, and those of what it wraps.
static void add_integrator(const struct object *o, struct json *out) {
    for (const struct param *p = o->type->params; p && p->name; p++) {
        const void *field = (const char *)o->data + p->offset;
        if (p->type == PARAM_INT)
            json_add_count(out, p->name, *(const int *)field);
        if (p->type == PARAM_BOOL)
            json_add_bool(out, p->name, *(const bool *)field);
        const struct object *nested = NULL;
        if (p->type == PARAM_INTEGRATOR)
            memcpy(&nested, field, sizeof nested);
        if (nested) {
            json_add_text(out, p->name, nested->type->name);
            add_integrator(nested, out);
        }
    }
}

static void add_geometry(const struct scene *s, const struct scene_summary *sum, struct json *out) {
    struct json *g = json_add_object(out, "geometry");
    json_add_count(g, "triangles", (int64_t)sum->triangles);
    json_add_count(g, "triangles_with_instances", (int64_t)sum->placed_triangles);
    json_add_count(g, "vertices", (int64_t)sum->vertices);
    json_add_count(g, "meshes", sum->meshes);
    json_add_count(g, "quadrics", sum->quadrics);
    json_add_count(g, "groups", sum->groups);
    json_add_count(g, "instances", sum->instances);
    struct json *min = json_add_array(out, "bounds_min"), *max = json_add_array(out, "bounds_max");
    for (int k = 0; k < 3; k++) {
        json_append_number(min, s->centre[k] + (double)s->bounds_min[k]);
        json_append_number(max, s->centre[k] + (double)s->bounds_max[k]);
    }
}

static uint32_t count_delta_lights(const struct world *w) {
    uint32_t n = 0;
    for (uint32_t i = 0; i < w->light_count; i++)
        n += w->lights[i].type->delta;
    return n;
}

static uint32_t lobes_in_use(const struct scene *s) {
    uint32_t lobes = 0;
    for (uint32_t i = 0; i < s->shape_count; i++)
        lobes |= bsdf_lobes(s->shapes[i].bsdf);
    return lobes;
}

// Of the media that vary in space, or whose extinction is coloured.
static uint32_t count_media(const struct world *w, bool coloured) {
    uint32_t n = 0;
    for (uint32_t i = 0; i < w->scene->medium_count; i++)
        n += coloured ? !w->media[i].grey : !w->media[i].homogeneous;
    return n;
}

static int64_t volume_bytes(const struct scene *s) {
    size_t sum = 0;
    for (uint32_t i = 0; i < s->volume_count; i++) {
        const struct volume_type *type = volume_type_of(s->volumes[i]);
        sum += type->bytes ? type->bytes(s->volumes[i]->data) : 0;
    }
    return (int64_t)sum;
}

// Every feature stands in one of two lists: what rendering this scene runs, and what it does not.
static void add_features(const struct job *job, const struct scene_summary *s, struct json *out) {
    const struct world *w = job->world;
    const uint32_t lobes = lobes_in_use(job->scene);
    const struct {
        const char *name;
        bool used;
    } features[] = {
        {"textures", s->textured_parameters > 0},
        {"mesh-attributes", s->meshes_with_attributes > 0},
        {"vertex-normals", s->meshes_with_normals > 0},
        {"tangents", w->tangents_matter},
        {"quadrics", s->quadrics > 0},
        {"instancing", s->instances > 0},
        {"diffuse-materials", (lobes & LOBE_DIFFUSE) != 0},
        {"glossy-materials", (lobes & LOBE_GLOSSY) != 0},
        {"specular-materials", (lobes & LOBE_SPECULAR) != 0},
        {"straight-through-shadow-rays", w->shadow_rays_may_pass},
        {"area-lights", s->emitting_shapes > 0},
        {"delta-lights", count_delta_lights(w) > 0},
        {"environment", w->infinite_count > 0},
        {"light-choice", w->choice.draws},
        {"light-tree", w->choice.has_tree},
        {"media", w->media != NULL},
        {"grid-media", count_media(w, false) > 0},
        {"coloured-extinction", count_media(w, true) > 0},
        {"camera-visibility", w->hides},
        {"light-linking", w->links},
        {"recentring", s->recentred},
        {"alpha", job->film.alpha},
    };
    struct json *used = json_add_array(out, "requires");
    struct json *unused = json_add_array(out, "does_not_require");
    for (size_t i = 0; i < sizeof features / sizeof *features; i++)
        json_append_text(features[i].used ? used : unused, features[i].name);
}

static void add_memory(const struct job *job, const struct scene_summary *s, struct json *out) {
    struct json *bytes = json_add_object(out, "bytes");
    json_add_count(bytes, "meshes", (int64_t)s->mesh_bytes);
    json_add_count(bytes, "volumes", volume_bytes(job->scene));
    json_add_count(bytes, "acceleration_structure", (int64_t)accel_bytes(job->world->accel));
    json_add_count(bytes, "light_choice", (int64_t)light_choice_bytes(&job->world->choice));
    json_add_count(bytes, "film", (int64_t)film_bytes(&job->film, job->render.tracer.spp));
    json_add_count(bytes, "peak_while_loading", (int64_t)mem_peak());
}

void scene_info_add(const struct job *job, struct json *out) {
    char hash[32];
    struct scene_summary s;
    scene_summary_init(&s, job->scene);
    snprintf(hash, sizeof hash, "%016" PRIx64, job->scene->hash);
    json_add_text(out, "kind", "scene");
    json_add_text(out, "hash", hash);
    add_view(job, out);
    add_integrator(job->scene->integrator, json_add_object(out, "integrator_parameters"));
    add_uses(&s, "shape", "shapes", out);
    add_geometry(job->scene, &s, out);
    add_uses(&s, "bsdf", "materials", out);
    add_uses(&s, "texture", "textures", out);
    add_uses(&s, "light", "lights", out);
    add_uses(&s, "medium", "media", out);
    add_uses(&s, "phase", "phase_functions", out);
    add_uses(&s, "volume", "volumes", out);
    add_features(job, &s, out);
    add_memory(job, &s, out);
    convergence_add(job, out);
    json_add_text(out, "ray_tracing", accel_version());
    json_add_number(out, "load_seconds", job->load_seconds);
    json_add_number(out, "acceleration_seconds", job->world->accel_seconds);
    json_add_count(out, "warnings", log_warning_count());
    scene_summary_finish(&s);
}
