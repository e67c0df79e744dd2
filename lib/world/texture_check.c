// SPDX-License-Identifier: Apache-2.0
// From each shape a walk down its material and its light. What a walk has met it does not enter again:
// shared objects would be met as often as there are ways to them.
#include "world/texture_check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "texture/texture.h"

enum { TOLD_RANGE = 1, TOLD_UV = 2, TOLD_ATTRIBUTE = 4 };

// An object that has others inside, or is a texture.
struct node {
    const struct object *object;
    uint32_t walk; // the last that met it
    unsigned told; // once is enough
};

struct check {
    struct node *nodes; // by address
    size_t count, capacity;
    // of the walk
    uint32_t walk;
    const struct shape *shape; // NULL: of a light that no shape has
};

// ---- objects ------------------------------------------------------------------------------------

static bool is_texture(const struct param *p) {
    return p->type == PARAM_TEXTURE || p->type == PARAM_TEXTURE_EMISSION ||
           p->type == PARAM_TEXTURE_SCALAR;
}

static const struct object *child_of(const struct object *o, const struct param *p) {
    const void *field = (const char *)o->data + p->offset;
    const struct object *child = NULL;
    if (p->type == PARAM_BSDF)
        memcpy(&child, field, sizeof child);
    else if (is_texture(p))
        child = ((const struct texture_ref *)field)->texture;
    return child;
}

static bool has_child(const struct object *o) {
    const struct param *p = o->type->params;
    while (p && p->name && !child_of(o, p))
        p++;
    return p && p->name;
}

static void add_node(struct check *c, const struct object *o) {
    mem_grow(&c->nodes, &c->capacity, c->count + 1, sizeof *c->nodes);
    c->nodes[c->count++] = (struct node){.object = o};
}

static int by_address(const void *a, const void *b) {
    const uintptr_t x = (uintptr_t)((const struct node *)a)->object;
    const uintptr_t y = (uintptr_t)((const struct node *)b)->object;
    return (x > y) - (x < y);
}

static void add_nodes(struct check *c, const struct scene *s) {
    for (uint32_t i = 0; i < s->texture_count; i++)
        add_node(c, s->textures[i]);
    for (uint32_t i = 0; i < s->bsdf_count; i++)
        if (has_child(s->bsdfs[i]))
            add_node(c, s->bsdfs[i]);
    for (uint32_t i = 0; i < s->light_count; i++)
        if (has_child(s->lights[i].object))
            add_node(c, s->lights[i].object);
    if (c->count)
        qsort(c->nodes, c->count, sizeof *c->nodes, by_address);
}

static struct node *find_node(const struct check *c, const struct object *o) {
    const struct node key = {.object = o};
    return c->count ? bsearch(&key, c->nodes, c->count, sizeof key, by_address) : NULL;
}

// Whether this is said of the texture for the first time.
static bool is_news(struct node *n, unsigned what) {
    const bool news = !(n->told & what);
    n->told |= what;
    return news;
}

// ---- attributes and coordinates -----------------------------------------------------------------

static void describe_attributes(const struct mesh *m, const char *name, char *hint, size_t size) {
    const char *nearest = NULL;
    size_t used = 0;
    int best = 1 << 20;
    snprintf(hint, size, "; it has none");
    for (uint32_t i = 0; i < m->attribute_count; i++)
        name_consider(m->attributes[i].name, m->attributes[i].name, name, &best, &nearest);
    if (nearest)
        snprintf(hint, size, "; did you mean \"%s\"?", nearest);
    for (uint32_t i = 0; !nearest && i < m->attribute_count && used < size; i++)
        used += (size_t)snprintf(hint + used, size - used, "%s %s", i ? "," : "; it has",
                                 m->attributes[i].name);
}

static bool check_attribute(struct node *n, const struct shape *shape, const char *name) {
    const struct object *texture = n->object;
    const bool may_lack = texture_type_of(texture)->replaces_uv;
    char hint[256];
    if (may_lack && !is_news(n, TOLD_ATTRIBUTE))
        return true;
    describe_attributes(&shape->mesh, name, hint, sizeof hint);
    if (may_lack)
        log_warn_at(texture->at, "%s: the shape \"%s\" of line %d has no attribute \"%s\" and keeps its own "
                    "coordinates%s", texture->type->name, shape->type, shape->at.line, name, hint);
    else
        log_error_at(texture->at, "%s: the shape \"%s\" of line %d has no attribute \"%s\"%s",
                     texture->type->name, shape->type, shape->at.line, name, hint);
    return may_lack;
}

static void warn_of_uv(struct node *n, const struct shape *shape) {
    if (is_news(n, TOLD_UV))
        log_warn_at(n->object->at, "%s: the mesh of the shape \"%s\" of line %d has no texture coordinates: "
                    "each of its triangles shows the same part of the texture", n->object->type->name,
                    shape->type, shape->at.line);
}

// ---- ranges -------------------------------------------------------------------------------------

// As a constant in the texture's place is checked when it is read.
static void check_range(struct node *n, const struct object *owner, const struct param *p,
                        const struct mesh *mesh) {
    const struct texture_range r = texture_type_of(n->object)->range(n->object->data, mesh);
    const bool scalar = p->type == PARAM_TEXTURE_SCALAR;
    const float least = scalar ? spectrum_luminance(r.least) : spectrum_min(r.least);
    const float most = scalar ? spectrum_luminance(r.most) : spectrum_max(r.most);
    const bool bounded = p->min != 0 || p->max != 0;
    if (!bounded || (least >= (float)p->min && most <= (float)p->max) || !is_news(n, TOLD_RANGE))
        return;
    const bool gains = p->type == PARAM_TEXTURE && p->max == 1 && most > 1;
    log_warn_at(owner->at, "%s: \"%s\" is the %s of line %d with values from %.7g to %.7g, expected %.7g "
                "to %.7g%s", owner->type->name, p->name, n->object->type->name, n->object->at.line,
                (double)least, (double)most, p->min, p->max,
                gains ? ": more light leaves than comes, without a limit of depth perhaps without end" : "");
}

// ---- walks --------------------------------------------------------------------------------------

// own_uv becomes whether textures inside are looked up by the coordinates of the surface itself.
static bool check_texture(const struct check *c, struct node *n, bool *own_uv) {
    const struct texture_type *type = texture_type_of(n->object);
    const char *name = c->shape && type->attribute ? type->attribute(n->object->data) : NULL;
    const bool has = name && mesh_find_attribute(&c->shape->mesh, name);
    if (name && !has && !check_attribute(n, c->shape, name))
        return false;
    if (type->reads_uv && *own_uv && c->shape && c->shape->kind == SHAPE_MESH && !c->shape->mesh.uvs)
        warn_of_uv(n, c->shape);
    *own_uv = *own_uv && !(has && type->replaces_uv);
    return true;
}

// Walks end: the reader refuses objects that contain themselves.
static bool walk(const struct check *c, const struct object *o, bool own_uv) {
    struct node *n = find_node(c, o);
    if (!n || n->walk == c->walk)
        return true;
    n->walk = c->walk;
    for (const struct param *p = o->type->params; p && p->name; p++) {
        const struct object *child = child_of(o, p);
        struct node *texture = child && is_texture(p) ? find_node(c, child) : NULL;
        bool uv_of_child = own_uv;
        if (texture)
            check_range(texture, o, p, c->shape ? &c->shape->mesh : NULL);
        if ((texture && !check_texture(c, texture, &uv_of_child)) ||
            (child && !walk(c, child, uv_of_child)))
            return false;
    }
    return true;
}

bool world_check_textures(const struct scene *s) {
    struct check c = {0};
    bool good = true;
    add_nodes(&c, s);
    for (uint32_t i = 0; i < s->shape_count && good; i++) {
        const uint32_t light = s->shapes[i].light;
        c.walk++;
        c.shape = &s->shapes[i];
        good = walk(&c, c.shape->bsdf, true) &&
               (light == SCENE_NONE || walk(&c, s->lights[light].object, true));
    }
    c.shape = NULL;
    c.walk++;
    for (uint32_t i = 0; i < s->light_count && good; i++)
        good = s->lights[i].shape != SCENE_NONE || walk(&c, s->lights[i].object, true);
    mem_free(c.nodes);
    return good;
}
