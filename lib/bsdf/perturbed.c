// SPDX-License-Identifier: Apache-2.0
#include "bsdf/perturbed.h"

struct perturbed_data {
    struct closure head;
    const struct closure *child;
    struct frame frame; // tilted frame in the local one
    vec3 wo;
    float shadowing; // alpha^2 of the shadowing function; 0: none
};

static struct frame tilt(const struct perturbation *p, vec3 n, vec3 wo) {
    if (p->flip_invalid_normals && cos_theta(wo) * dot(wo, n) <= 0)
        n = v3(-n[0], -n[1], n[2]);
    n = normalize(n);
    if (!(length2(n) > 0.5f))
        n = v3(0, 0, 1);
    return frame_from_normal_tangent(n, v3(1, 0, 0));
}

static struct bsdf_point tilt_point(const struct bsdf_point *point, const struct frame *f) {
    struct bsdf_point tilted = *point;
    tilted.frame.s = to_world(&point->frame, f->s);
    tilted.frame.t = to_world(&point->frame, f->t);
    tilted.frame.n = to_world(&point->frame, f->n);
    return tilted;
}

const struct closure *perturbed_resolve(const struct perturbation *p, const struct object *child,
                                        vec3 n, const struct bsdf_point *point, vec3 wo,
                                        struct closure_stack *stack) {
    const struct frame f = tilt(p, n, wo);
    const struct bsdf_point tilted = tilt_point(point, &f);
    const struct closure *inner = bsdf_resolve(child, &tilted, to_local(&f, wo), stack);
    if (!inner)
        return NULL;
    struct perturbed_data *c = closure_alloc(stack, &bsdf_bumpmap, sizeof *c, inner->lobes);
    c->child = inner;
    c->frame = f;
    c->wo = wo;
    // A normal seldom looks straight at the horizon; where it does, everything is shadowed.
    const float tan2 = f.n[2] != 0 ? tan2_theta(f.n) : INFINITY;
    c->shadowing = p->use_shadowing_function ? minf(0.125f * tan2, 1) : 0;
    return &c->head;
}

spectrum perturbed_null_transmittance(const struct perturbation *p, const struct object *child,
                                      vec3 n, const struct bsdf_point *point, vec3 wo) {
    const struct frame f = tilt(p, n, wo);
    const struct bsdf_point tilted = tilt_point(point, &f);
    return bsdf_null_transmittance(child, &tilted, to_local(&f, wo));
}

// 2 / (1 + sqrt(1 + alpha^2 tan^2)): GGX masking with a roughness that the tilt suggests.
static float shadowing(const struct perturbed_data *c, vec3 wi) {
    const float z = fabsf(cos_theta(wi));
    return 2 * z / (z + sqrtf(z * z + c->shadowing * sin2_theta(wi)));
}

spectrum perturbed_eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct perturbed_data *c = (const void *)closure;
    const vec3 tilted = to_local(&c->frame, wi);
    *pdf_sa = 0;
    if (!same_hemisphere(tilted, wi))
        return spectrum_grey(0);
    return closure_eval(c->child, tilted, pdf_sa) * shadowing(c, wi);
}

const struct closure *perturbed_inside(const struct closure *closure, vec3 *wi, float *factor) {
    const struct perturbed_data *c = (const void *)closure;
    const vec3 tilted = to_local(&c->frame, *wi);
    *factor *= same_hemisphere(tilted, *wi) ? shadowing(c, *wi) : 0;
    *wi = tilted;
    return c->child;
}

bool perturbed_sample(const struct closure *closure, float u1, struct vec2 u2,
                      struct bsdf_sample *s) {
    const struct perturbed_data *c = (const void *)closure;
    if (!closure_sample(c->child, u1, u2, s))
        return false;
    if (s->lobe & LOBE_NULL) {
        s->wi = -c->wo;
        return true;
    }
    const vec3 tilted = s->wi;
    s->wi = normalize(to_world(&c->frame, tilted));
    if (!same_hemisphere(tilted, s->wi))
        return false;
    s->weight *= shadowing(c, s->wi);
    return true;
}

spectrum perturbed_albedo(const struct closure *closure) {
    return closure_albedo(((const struct perturbed_data *)(const void *)closure)->child);
}
