// SPDX-License-Identifier: Apache-2.0
#include "scene/summary.h"

#include <string.h>

#include "texture/texture.h"

struct counting {
    struct scene_summary *out;
    size_t capacity;
};

static void count_use(struct counting *c, const char *kind, const char *name) {
    struct scene_summary *s = c->out;
    for (uint32_t i = 0; i < s->use_count; i++)
        if (strcmp(s->uses[i].kind, kind) == 0 && strcmp(s->uses[i].name, name) == 0) {
            s->uses[i].count++;
            return;
        }
    mem_grow(&s->uses, &c->capacity, s->use_count + 1, sizeof *s->uses);
    s->uses[s->use_count++] = (struct scene_use){kind, name, 1};
}

static uint64_t mesh_bytes(const struct mesh *m) {
    uint64_t vertex = sizeof *m->positions, face = sizeof *m->indices;
    vertex += m->normals ? sizeof *m->normals : 0;
    vertex += m->uvs ? sizeof *m->uvs : 0;
    for (uint32_t i = 0; i < m->attribute_count; i++)
        *(m->attributes[i].per_face ? &face : &vertex) +=
            (uint64_t)m->attributes[i].channels * sizeof(float);
    return vertex * m->vertex_count + face * m->triangle_count;
}

static void count_shapes(struct counting *c, const struct scene *scene) {
    struct scene_summary *s = c->out;
    uint64_t *in_group = mem_array(scene->group_count, sizeof *in_group);
    for (uint32_t i = 0; i < scene->shape_count; i++) {
        const struct shape *shape = &scene->shapes[i];
        const struct mesh *m = &shape->mesh;
        const bool is_mesh = shape->kind == SHAPE_MESH;
        count_use(c, "shape", shape->type);
        *(is_mesh ? &s->meshes : &s->quadrics) += 1;
        s->emitting_shapes += shape->light != SCENE_NONE;
        s->triangles += m->triangle_count;
        s->vertices += m->vertex_count;
        s->mesh_bytes += is_mesh ? mesh_bytes(m) : 0;
        s->meshes_with_normals += m->normals != NULL;
        s->meshes_with_uvs += m->uvs != NULL;
        s->meshes_with_attributes += m->attribute_count > 0;
        *(shape->group == SCENE_NONE ? &s->placed_triangles : &in_group[shape->group]) +=
            m->triangle_count;
    }
    for (uint32_t i = 0; i < scene->instance_count; i++)
        s->placed_triangles += in_group[scene->instances[i].group];
    mem_free(in_group);
}

static uint32_t textured(const struct object *o) {
    uint32_t n = 0;
    for (const struct param *p = o->type->params; p && p->name; p++)
        if (p->type == PARAM_TEXTURE || p->type == PARAM_TEXTURE_EMISSION ||
            p->type == PARAM_TEXTURE_SCALAR)
            n += ((const struct texture_ref *)((const char *)o->data + p->offset))->texture != NULL;
    return n;
}

void scene_summary_init(struct scene_summary *summary, const struct scene *scene) {
    memset(summary, 0, sizeof *summary);
    struct counting c = {summary, 0};
    count_shapes(&c, scene);
    for (uint32_t i = 0; i < scene->bsdf_count; i++) {
        count_use(&c, "bsdf", scene->bsdfs[i]->type->name);
        summary->textured_parameters += textured(scene->bsdfs[i]);
    }
    for (uint32_t i = 0; i < scene->texture_count; i++)
        count_use(&c, "texture", scene->textures[i]->type->name);
    for (uint32_t i = 0; i < scene->medium_count; i++)
        count_use(&c, "medium", scene->media[i]->type->name);
    for (uint32_t i = 0; i < scene->phase_count; i++)
        count_use(&c, "phase", scene->phases[i]->type->name);
    for (uint32_t i = 0; i < scene->volume_count; i++)
        count_use(&c, "volume", scene->volumes[i]->type->name);
    for (uint32_t i = 0; i < scene->light_count; i++) {
        count_use(&c, "light", scene->lights[i].object->type->name);
        summary->textured_parameters += textured(scene->lights[i].object);
        summary->other_lights += scene->lights[i].shape == SCENE_NONE;
    }
    for (uint32_t i = 0; i < scene->sensor_count; i++)
        count_use(&c, "sensor", scene->sensors[i]->type->name);
    const struct object *const single[] = {scene->sampler, scene->filter, scene->integrator};
    static const char *const kinds[] = {"sampler", "filter", "integrator"};
    for (int i = 0; i < 3; i++)
        if (single[i])
            count_use(&c, kinds[i], single[i]->type->name);
    summary->groups = scene->group_count;
    summary->instances = scene->instance_count;
    summary->recentred =
        scene->centre[0] != 0 || scene->centre[1] != 0 || scene->centre[2] != 0;
}

void scene_summary_finish(struct scene_summary *summary) {
    mem_free(summary->uses);
    summary->uses = NULL;
    summary->use_count = 0;
}
