// SPDX-License-Identifier: Apache-2.0
#include "driver/edit_pixels.h"

#include "base/mem.h"
#include "base/thread.h"
#include "sink/tile_grid.h"
#include "transport/tensor.h"

struct looking {
    struct edit_pixels *pixels;
    struct light_loop *const *loops;
};

static void region_corner(const struct edit_pixels *p, size_t region, int *x, int *y) {
    *x = (p->area.x0 / EDIT_REGION + (int)region % p->regions_x) * EDIT_REGION;
    *y = (p->area.y0 / EDIT_REGION + (int)region / p->regions_x) * EDIT_REGION;
}

// Pixel i of a region in the order of the lists.
static void region_pixel(int x0, int y0, uint32_t i, int *x, int *y) {
    const int block = (int)i / LIGHT_LOOP_PIXELS, inside = (int)i % LIGHT_LOOP_PIXELS;
    *x = x0 + block % 2 * LIGHT_LOOP_SIDE + inside % LIGHT_LOOP_SIDE;
    *y = y0 + block / 2 * LIGHT_LOOP_SIDE + inside / LIGHT_LOOP_SIDE;
}

static size_t area_index(const struct edit_pixels *p, int x, int y) {
    return (size_t)(y - p->area.y0) * (size_t)(p->area.x1 - p->area.x0) + (size_t)(x - p->area.x0);
}

// Notes views; `place` says for now whether the pixel shows the object.
static void look_at_region(void *ctx, size_t region, int worker) {
    const struct looking *k = ctx;
    const struct edit_pixels *p = k->pixels;
    struct light_loop *loop = k->loops[worker];
    int x0, y0;
    accel_thread_init();
    region_corner(p, region, &x0, &y0);
    for (uint32_t i = 0; i < EDIT_REGION * EDIT_REGION; i++) {
        int x, y;
        region_pixel(x0, y0, i, &x, &y);
        if (i % LIGHT_LOOP_PIXELS == 0)
            light_loop_see(loop, x, y);
        if (!sink_area_has(&p->area, x, y))
            continue;
        for (uint32_t o = 0; o < p->object_count; o++) {
            const bool shows = light_loop_shows(loop, i % LIGHT_LOOP_PIXELS, o);
            p->lists[o].place[area_index(p, x, y)] = shows ? 0 : UINT32_MAX;
            if (shows)
                p->lists[o].view[area_index(p, x, y)] =
                    light_loop_view(loop, i % LIGHT_LOOP_PIXELS, o);
        }
    }
}

// From views by pixel to a list.
static void make_list(const struct edit_pixels *p, struct edit_pixels_list *l, int width) {
    const size_t pixels = (size_t)(p->area.x1 - p->area.x0) * (size_t)(p->area.y1 - p->area.y0);
    const float *views = l->view;
    l->pixels = mem_array(pixels, sizeof *l->pixels);
    l->view = mem_array(pixels + TENSOR_LANES, sizeof *l->view);
    for (uint32_t region = 0; region < edit_pixels_regions(p); region++)
        for (uint32_t i = 0; i < EDIT_REGION * EDIT_REGION; i++) {
            int x0, y0, x, y;
            region_corner(p, region, &x0, &y0);
            region_pixel(x0, y0, i, &x, &y);
            if (!sink_area_has(&p->area, x, y) || l->place[area_index(p, x, y)] == UINT32_MAX)
                continue;
            l->place[area_index(p, x, y)] = l->count;
            l->view[l->count] = views[area_index(p, x, y)];
            l->pixels[l->count++] = (uint32_t)(y * width + x);
        }
    mem_free((void *)(uintptr_t)views);
}

void edit_pixels_init(struct edit_pixels *p, struct light_loop *const *loops, int threads,
                      uint32_t object_count, const struct sink_area *area, int width) {
    const size_t pixels = (size_t)(area->x1 - area->x0) * (size_t)(area->y1 - area->y0);
    struct looking k = {p, loops};
    *p = (struct edit_pixels){
        .area = *area, .object_count = object_count,
        .regions_x = (area->x1 - 1) / EDIT_REGION - area->x0 / EDIT_REGION + 1,
        .regions_y = (area->y1 - 1) / EDIT_REGION - area->y0 / EDIT_REGION + 1,
        .lists = mem_array(object_count, sizeof *p->lists)};
    for (uint32_t i = 0; i < object_count; i++) {
        p->lists[i].place = mem_array(pixels, sizeof *p->lists[i].place);
        p->lists[i].view = mem_array(pixels, sizeof *p->lists[i].view);
    }
    thread_for(threads, edit_pixels_regions(p), look_at_region, &k);
    for (uint32_t i = 0; i < object_count; i++)
        make_list(p, &p->lists[i], width);
}

void edit_pixels_finish(struct edit_pixels *p) {
    for (uint32_t i = 0; i < p->object_count; i++) {
        mem_free(p->lists[i].pixels);
        mem_free(p->lists[i].view);
        mem_free(p->lists[i].place);
    }
    mem_free(p->lists);
    *p = (struct edit_pixels){.object_count = 0};
}

uint32_t edit_pixels_place(const struct edit_pixels *p, uint32_t object, int x, int y) {
    return sink_area_has(&p->area, x, y) ? p->lists[object].place[area_index(p, x, y)] : UINT32_MAX;
}

bool edit_pixels_any(const struct edit_pixels *p, int x, int y) {
    for (uint32_t o = 0; o < p->object_count; o++)
        for (int i = 0; i < LIGHT_LOOP_PIXELS; i++)
            if (edit_pixels_place(p, o, x + i % LIGHT_LOOP_SIDE, y + i / LIGHT_LOOP_SIDE) != UINT32_MAX)
                return true;
    return false;
}

static bool region_shows(const struct edit_pixels *p, uint32_t region) {
    int x, y;
    region_corner(p, region, &x, &y);
    for (int i = 0; i < 4; i++)
        if (edit_pixels_any(p, x + i % 2 * LIGHT_LOOP_SIDE, y + i / 2 * LIGHT_LOOP_SIDE))
            return true;
    return false;
}

uint32_t edit_pixels_shown(const struct edit_pixels *p) {
    uint32_t shown = 0;
    for (uint32_t i = 0; i < edit_pixels_regions(p); i++)
        shown += region_shows(p, i);
    return shown;
}

uint32_t edit_pixels_spread(const struct edit_pixels *p, uint32_t *regions, uint32_t most) {
    const uint32_t shown = edit_pixels_shown(p), count = shown < most ? shown : most;
    uint32_t seen = 0, taken = 0;
    for (uint32_t i = 0; i < edit_pixels_regions(p) && taken < count; i++) {
        if (!region_shows(p, i))
            continue;
        if ((uint64_t)seen++ * count >= (uint64_t)taken * shown)
            regions[taken++] = i;
    }
    return taken;
}
