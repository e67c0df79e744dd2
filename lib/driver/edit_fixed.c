// SPDX-License-Identifier: Apache-2.0
#include "driver/edit_fixed.h"

// The material, but black where it can be edited.
struct fixed_response {
    struct response head;
    const struct edit_plan *plan;
};

static const struct closure *resolve_fixed(const struct response *self,
                                           const struct trace_context *ctx, int lane,
                                           uint32_t depth, const struct surface *s, vec3 wo) {
    const struct closure *c = response_physical.resolve(&response_physical, ctx, lane, depth, s, wo);
    vec3 wi = v3(0, 0, 1);
    float factor = 1;
    const struct closure *inner = c ? editable_inside(c, &wi, &factor) : NULL;
    const struct edit_plan *plan = ((const struct fixed_response *)(const void *)self)->plan;
    return inner && edit_plan_find(plan, editable_owner(inner)) != EDIT_NONE ? NULL : c;
}

static void place(const struct image *im, const struct job *job, float *planes) {
    const struct film_options *f = &job->film;
    const size_t width = (size_t)job->scene->film.width;
    const size_t plane = width * (size_t)job->scene->film.height;
    for (int y = 0; y < im->height; y++)
        for (int x = 0; x < im->width; x++)
            for (int k = 0; k < 3; k++)
                planes[(size_t)k * plane + (size_t)(f->y0 + y) * width + (size_t)(f->x0 + x)] =
                    im->pixels[((size_t)y * (size_t)im->width + (size_t)x) * (size_t)im->channels +
                               (size_t)k];
}

bool edit_fixed_render(struct job *job, const struct edit_plan *plan, float *planes) {
    const struct fixed_response response = {{resolve_fixed}, plan};
    struct render_result result;
    struct image im;
    job->render.tracer.response = &response.head;
    struct film *film = job_render(job, &result);
    const bool made = !result.stopped && film_image(film, &im);
    job->render.tracer.response = NULL;
    film_destroy(film);
    if (!made)
        return false;
    place(&im, job, planes);
    image_finish(&im);
    return true;
}
